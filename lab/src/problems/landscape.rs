//! Recorded landscapes: the tolerable range of every design of a space, and what is firm of some.

use ask_tell::{Grid, GridPoint};
use input::InputError;
use std::collections::BTreeMap;

/// Column of the values; the columns before it are the axes.
const VALUE: &str = "range_mm";
/// Columns of what confirms a design, where the landscape has them.
const FIRM: [&str; 2] = ["repeated_mm", "firm_mm"];

/// Tolerable range of every design of a space, mm; `None` where the evaluation diverged.
#[derive(Debug, Clone, PartialEq)]
pub struct Landscape {
    pub grid: Grid,
    /// By level of each axis.
    values: BTreeMap<Vec<u32>, Option<f64>>,
    /// Firm ranges of some, within the searched window and within the walked one, mm.
    firm: BTreeMap<Vec<u32>, [f64; 2]>,
}

/// A line: the axes, the value, the firm ranges.
type Row = (Vec<f64>, Option<f64>, Option<[f64; 2]>);

impl Landscape {
    /// Landscape of a CSV: a header, the axes, then `range_mm` (empty for no value), then anything.
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        let fail =
            |message: String| InputError::Syntax { file: file.to_owned(), line: None, message };
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let header = lines.next().unwrap_or_default();
        let axes = header.split(',').position(|name| name == VALUE).filter(|&axes| axes > 0);
        let axes = axes
            .ok_or_else(|| format!("the header must name the axes and then {VALUE}: '{header}'"));
        let axes = axes.map_err(fail)?;
        let firm = FIRM.map(|firm| header.split(',').position(|name| name == firm));
        let row = |line: &str| {
            row(line, axes, firm).ok_or_else(|| {
                format!("'{line}' does not begin with {axes} finite numbers and {VALUE}")
            })
        };
        let rows = lines.map(row).collect::<Result<Vec<_>, _>>();
        rows.and_then(|rows| Self::of(&rows, axes)).map_err(fail)
    }

    fn of(rows: &[Row], axes: usize) -> Result<Self, String> {
        let levels: Vec<Vec<f64>> = (0..axes)
            .map(|axis| {
                let mut levels: Vec<f64> = rows.iter().map(|(at, ..)| at[axis]).collect();
                levels.sort_by(f64::total_cmp);
                levels.dedup();
                levels
            })
            .collect();
        let grid = Grid::new(levels.iter().map(|l| l.len() as u32).collect());
        if rows.is_empty() || grid.size() != rows.len() as u64 {
            return Err(format!("{} rows for a grid of {} designs", rows.len(), grid.size()));
        }
        let (mut values, mut firm) = (BTreeMap::new(), BTreeMap::new());
        for (at, value, confirmed) in rows {
            // Every number is among the levels: they were made of the rows.
            let level = |(at, levels): (&f64, &Vec<f64>)| levels.partition_point(|l| l < at) as u32;
            let point: Vec<u32> = at.iter().zip(&levels).map(level).collect();
            if let Some(confirmed) = confirmed {
                firm.insert(point.clone(), *confirmed);
            }
            if values.insert(point, *value).is_some() {
                return Err(format!("two rows of the design {at:?}"));
            }
        }
        if values.values().all(Option::is_none) {
            return Err("no design has a value".to_owned());
        }
        Ok(Landscape { grid, values, firm })
    }

    pub fn value(&self, point: &GridPoint) -> Option<f64> {
        self.values.get(&point.0).copied().flatten()
    }

    /// Firm ranges of a design within its searched and its walked window, mm. Of a design that was
    /// not confirmed its range less the drops of the nearest one that was.
    pub fn firm(&self, point: &GridPoint) -> Option<[f64; 2]> {
        let value = self.value(point)?;
        if let Some(firm) = self.firm.get(&point.0) {
            return Some(*firm);
        }
        let far = |other: &Vec<u32>| -> u64 {
            other.iter().zip(&point.0).map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2)).sum()
        };
        let nearest = self.firm.iter().min_by_key(|(other, _)| far(other));
        let drops = nearest.and_then(|(other, firm)| {
            let own = self.values.get(other).copied().flatten()?;
            Some(firm.map(|firm| own - firm))
        });
        Some(drops.unwrap_or([0.0; 2]).map(|drop| (value - drop).max(0.0)))
    }

    /// The largest firm range within a walked window; of a landscape without any the largest value.
    pub fn best_firm(&self) -> f64 {
        let firm = self.firm.values().map(|[_, firm]| *firm).reduce(f64::max);
        firm.unwrap_or_else(|| self.best())
    }

    pub fn best(&self) -> f64 {
        self.values.values().flatten().copied().fold(f64::NEG_INFINITY, f64::max)
    }
}

fn row(line: &str, axes: usize, firm: [Option<usize>; 2]) -> Option<Row> {
    let number = |cell: &str| cell.parse::<f64>().ok().filter(|number| number.is_finite());
    let mut cells = line.split(',');
    let at = cells.by_ref().take(axes).map(number).collect::<Option<Vec<f64>>>()?;
    let value = match cells.next()? {
        "" => None,
        cell => Some(number(cell)?),
    };
    let cell = |place: Option<usize>| line.split(',').nth(place?).and_then(number);
    let [repeated, walked] = firm.map(cell);
    let firm = repeated.zip(walked).map(|(repeated, walked)| [repeated, walked]);
    (at.len() == axes).then_some((at, value, firm))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "# x\na_percent,b_deg,range_mm,more\n10,0,1.5,7\n10,5,2.0,\n\
                         20,5,,\n20,0,0.1,\n30,0,3.0,\n30,5,2.9,\n";

    #[test]
    fn values_stand_at_their_designs_in_any_order() {
        let landscape = Landscape::parse(SMALL, "small.csv").unwrap();
        assert_eq!(landscape.grid.levels(), [3, 2]);
        let at = |a, b| landscape.value(&GridPoint(vec![a, b]));
        let found = [at(0, 1), at(1, 0), at(1, 1), at(2, 1)];
        assert_eq!(found, [Some(2.0), Some(0.1), None, Some(2.9)]);
        assert_eq!(landscape.best(), 3.0);
    }

    #[test]
    fn what_is_no_landscape_is_named() {
        for (text, part) in [
            ("", "the header must name"),
            ("range_mm\n1\n", "the header must name"),
            ("a,range_mm\n", "0 rows"),
            ("a,range_mm\n1,\n", "no design has a value"),
            ("a,range_mm\n1,x\n", "'1,x' does not begin"),
            ("a,range_mm\n1\n", "'1' does not begin"),
            ("a,b,range_mm\n1,1,1\n2,2,1\n", "2 rows for a grid of 4"),
            ("a,b,range_mm\n1,1,1\n1,1,2\n1,2,1\n2,2,1\n", "two rows of the design [1.0, 1.0]"),
        ] {
            let error = Landscape::parse(text, "l.csv").unwrap_err().to_string();
            assert!(error.starts_with("l.csv: ") && error.contains(part), "{error}");
        }
    }
}
