//! Exact sums of decimal numbers: 0.1 + 2 times 0.1 is 0.3, whatever binary numbers say, and
//! steps of 1 from 1e15 on are not rounded together.

/// `digits` times ten to the power of `exponent`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Decimal {
    digits: i128,
    exponent: i32,
}

impl Decimal {
    /// The shortest decimal number that reads back as `value`; `None` if it is not finite.
    pub fn of(value: f64) -> Option<Decimal> {
        let text = format!("{value:e}");
        let (mantissa, exponent) = text.split_once('e')?;
        let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let exponent: i32 = exponent.parse().ok()?;
        let digits = mantissa.replace('.', "").parse().ok()?;
        Some(Decimal { digits, exponent: exponent - i32::try_from(decimals).ok()? })
    }

    /// This and `k` times another; `None` if that has more digits than are kept.
    pub fn plus(self, k: i128, other: Decimal) -> Option<Decimal> {
        let exponent = self.exponent.min(other.exponent);
        let more = other.digits_at(exponent)?.checked_mul(k)?;
        Some(Decimal { digits: self.digits_at(exponent)?.checked_add(more)?, exponent })
    }

    /// This over ten to a power.
    pub fn over_ten_to(self, power: i32) -> Decimal {
        Decimal { exponent: self.exponent - power, ..self }
    }

    fn digits_at(self, exponent: i32) -> Option<i128> {
        let power = u32::try_from(self.exponent - exponent).ok()?;
        self.digits.checked_mul(10i128.checked_pow(power)?)
    }

    /// The binary number nearest to it.
    pub fn nearest(self) -> f64 {
        format!("{}e{}", self.digits, self.exponent).parse().unwrap_or(f64::NAN)
    }
}
