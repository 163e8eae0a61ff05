//! Holes: where they lie, what they leave unchanged, and which do not fit.

use super::infill;
use crate::geometry::Geometry;
use crate::infill::InfillDesign;
use crate::mechanics::compute;
use crate::polygon;
use crate::printed::PrintedFinger;
use input::units::MM;

const THROUGH: &str = "[holes]\naxis = \"depth\"\nrow = \"width\"\ncount = 2\nspacing_mm = 8.0\n\
                       diameter_mm = 3.2\noffset_mm = [0.5, 1.0]\n";
const ALONG: &str = "[holes]\naxis = \"length\"\nrow = \"width\"\ncount = 2\nspacing_mm = 22.0\n\
                     diameter_mm = 3.2\noffset_mm = [0.0, 0.0]\n\
                     [holes.block]\nlength_mm = 5.0\nwidth_mm = 30.0\noverlap_mm = 1.0\n";

fn geometry(holes: &str) -> Result<Geometry, String> {
    let text = include_str!("../../../../fingers/finray9.toml").to_owned() + holes;
    let finger = PrintedFinger::parse(&text, "f.toml").map_err(|error| error.to_string())?;
    let design = InfillDesign { density_percent: 20.0, direction_deg: 20.0, phase_mm: None };
    Geometry::new(&finger, &design).map_err(|error| error.to_string())
}

#[test]
fn holes_are_round_and_change_no_stiffness() {
    let (plain, holed) = (infill(20.0, 20.0), geometry(THROUGH).unwrap());
    assert_eq!(compute(&plain), compute(&holed));
    assert_eq!(compute(&plain), compute(&geometry(ALONG).unwrap()));
    let rings = holed.holes();
    let middle = |x: f64, y: f64| nalgebra::Point2::new(x * MM, y * MM);
    for (ring, centre) in rings.iter().zip([middle(48.85, -11.3), middle(48.85, -3.3)]) {
        assert!(polygon::area(ring) < 0.0);
        for (a, b) in polygon::edges(ring) {
            assert!(((a - centre).norm() - 1.6 * MM).abs() < 1e-9);
            assert!((nalgebra::center(&a, &b) - centre).norm() > 1.59 * MM);
        }
    }
    let lost = 2.0 * std::f64::consts::PI * (1.6 * MM).powi(2);
    assert!(((plain.area() - holed.area()) / lost - 1.0).abs() < 0.01);
    assert_eq!(holed.rings_mm().len(), plain.rings_mm().len() + 2);
}

#[test]
fn holes_that_do_not_fit_are_refused_by_their_key() {
    let sole = THROUGH.replace("depth", "width");
    let cases = [
        (THROUGH, "spacing_mm = 8.0", "spacing_mm = 4.0", ["of 0.8 mm between", "at least 1.2"]),
        (THROUGH, "spacing_mm = 8.0", "spacing_mm = 12.0", ["-0.3 mm at the ends", "1.2"]),
        (THROUGH, "[0.5, 1.0]", "[0.5, 2.5]", ["f.toml: holes", "0.85 mm beside"]),
        (THROUGH, "[0.5, 1.0]", "[0.5, nan]", ["holes.offset_mm", "-1000 .. 1000"]),
        (THROUGH, "count = 2", "count = 0", ["holes.count", "1 .. 20"]),
        (THROUGH, "diameter_mm = 3.2", "diameter_mm = 0.5", ["holes.diameter_mm", "1 .. 500"]),
        (THROUGH, "\"depth\"", "\"up\"", ["up", "length"]),
        (THROUGH, "\"width\"", "\"depth\"", ["holes.row", "\"length\" or \"width\""]),
        (&sole, "row = \"width\"", "row = \"length\"", ["holes.block", "overlap_mm"]),
        (ALONG, "overlap_mm = 1.0", "overlap_mm = 10.0", ["holes.block.overlap_mm", "9.9"]),
        (ALONG, "overlap_mm = 1.0", "overlap_mm = 0.0", ["holes.block.overlap_mm", "1e-9 .. 500"]),
        (ALONG, "spacing_mm = 22.0", "spacing_mm = 15.0", ["holes.offset_mm", "beside it"]),
    ];
    for (holes, from, to, parts) in cases {
        assert!(holes.contains(from), "{from}");
        let error = geometry(&holes.replace(from, to)).unwrap_err();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}
