//! Link functions: map stiffness to the scale on which a model is linear, and back to a positive stiffness.

/// Function of the stiffness in which the terms of a model are additive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum LinkKind {
    /// The stiffness itself: springs in parallel.
    Identity,
    /// Its inverse: springs in series.
    Inverse,
    /// Its logarithm: factors on the computed stiffness.
    Log,
}

/// Maps stiffness to the scale on which a model is linear, and back.
///
/// With `q` the function of the stiffness, `q = s ln(1 + exp(g / s))` (soft plus): the identity for
/// `q` well above `s`, and positive for every `g`. `s` is a quarter of the smallest `q` measured,
/// so within the data the soft plus changes values by less than 0.5 %.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Link {
    pub kind: LinkKind,
    /// Scale `s` of the soft plus; `None` for `q = g`.
    pub scale: Option<f64>,
}

impl Link {
    /// Returns the link for these stiffnesses, N/m.
    pub fn new<'a>(kind: LinkKind, stiffness: impl IntoIterator<Item = &'a f64>) -> Self {
        let plain = Link { kind, scale: None };
        let smallest =
            stiffness.into_iter().map(|&k| plain.forward(k)).fold(f64::INFINITY, f64::min);
        Link { kind, scale: Some(smallest / 4.0) }
    }

    pub const IDENTITY: Link = Link { kind: LinkKind::Identity, scale: None };

    /// Returns the value on the linear scale for a stiffness, N/m.
    pub fn forward(self, stiffness: f64) -> f64 {
        let q = match self.kind {
            LinkKind::Identity => stiffness,
            LinkKind::Inverse => 1.0 / stiffness,
            LinkKind::Log => libm::log(stiffness),
        };
        // q + s ln(1 - exp(-q / s)): the inverse of soft plus, without overflow.
        self.scale.map_or(q, |s| q + s * libm::log1p(-libm::exp(-q / s)))
    }

    /// Returns the stiffness, N/m, and its slope for a value on the linear scale.
    pub fn backward(self, g: f64) -> (f64, f64) {
        let (q, slope) = match self.scale {
            None => (g, 1.0),
            Some(s) => {
                // Limited so that the inverse of q does not overflow.
                let x = (g / s).max(-50.0);
                // max(x, 0) + ln(1 + exp(-|x|)) does not overflow.
                let excess = libm::log1p(libm::exp(-x.abs()));
                (s * (x.max(0.0) + excess), 1.0 / (1.0 + libm::exp(-x)))
            }
        };
        match self.kind {
            LinkKind::Identity => (q, slope),
            LinkKind::Inverse => (1.0 / q, slope / (q * q)),
            LinkKind::Log => (libm::exp(q), slope * libm::exp(q)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn back_and_forth_is_the_identity_and_everything_is_positive() {
        for kind in [LinkKind::Identity, LinkKind::Inverse] {
            let link = Link::new(kind, &[1200.0, 3000.0, 75_000.0]);
            for k in [700.0, 1200.0, 2500.0, 80_000.0] {
                assert!((link.backward(link.forward(k)).0 / k - 1.0).abs() < 1e-9);
            }
            let unit = link.forward(2500.0).abs();
            for g in [-1e6, -5.0, 0.0, 1.0, 20.0] {
                let (k, slope) = link.backward(g * unit);
                assert!(k > 0.0 && slope > 0.0, "{kind:?} {g}: {k} {slope}");
            }
        }
    }
}
