//! Profile: positions of the ribs, area, mesh, and combinations of parts that are rejected.

use super::{finray9, infill};
use crate::geometry::Geometry;
use crate::infill::InfillDesign;
use crate::mechanics::compute;
use crate::mesh::Mesh;
use crate::picture;
use crate::polygon::{self, Ring};
use crate::printed::PrintedFinger;
use input::units::{GRAM, MM};

const MIDDLE: InfillDesign =
    InfillDesign { density_percent: 20.0, direction_deg: 20.0, phase_mm: None };

/// In the CAD, ribs at 10 % and 0 degrees have their centre lines at X = 4.143 + 3.81 n mm.
#[test]
fn ribs_have_the_positions_of_the_cad() {
    let geometry = infill(10.0, 0.0);
    let span = |void: &Ring| {
        let x = void.iter().map(|p| p.x / MM);
        x.fold([f64::MAX, f64::MIN], |[low, high], x| [low.min(x), high.max(x)])
    };
    let mut spans: Vec<[f64; 2]> = geometry.voids.iter().map(span).collect();
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for (n, pair) in spans.windows(2).enumerate() {
        let centre = (pair[0][1] + pair[1][0]) / 2.0;
        assert!((centre - (4.143 + 3.81 * n as f64)).abs() < 1e-6, "{centre}");
        assert!((pair[1][0] - pair[0][1] - 0.38).abs() < 1e-6);
    }
}

#[test]
fn a_positive_direction_tilts_the_front_ends_of_the_ribs_towards_the_base() {
    let geometry = infill(20.0, 30.0);
    let edges = polygon::edges(&geometry.voids[8]).map(|(a, b)| b - a);
    let long = edges.max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap();
    assert!((long.x / long.y - libm::tan(30f64.to_radians())).abs() < 1e-9, "{long}");
}

#[test]
fn mesh_and_profile_have_the_same_area_and_the_solid_is_left_of_every_ring() {
    for (density, direction) in [(10.0, 0.0), (15.0, 30.0), (25.0, 40.0), (30.0, -20.0)] {
        let geometry = infill(density, direction);
        let Geometry { outer, voids, .. } = &geometry;
        let mesh = Mesh::new(outer, voids, 1.0 * MM).unwrap();
        let area = (0..mesh.triangles.len()).map(|t| polygon::area(&mesh.corners(t))).sum::<f64>();
        assert!((area / geometry.area() - 1.0).abs() < 1e-9);
        assert!(polygon::area(outer) > 0.0);
        for void in voids {
            assert!(polygon::area(void) < 0.0 && !polygon::crosses_itself(void));
        }
        assert_eq!(geometry.rings_mm().len(), 1 + voids.len());
    }
}

/// The mass is the area of the profile times depth and density.
#[test]
fn the_finger_has_a_mass_of_some_grams() {
    let geometry = infill(20.0, 20.0);
    assert!((4.0..6.0).contains(&(geometry.mass() / GRAM)), "{} g", geometry.mass() / GRAM);
    assert_eq!(geometry.mass(), geometry.area() * 12.0 * MM * 1270.0);
}

/// Phases and directions in fine steps: narrow openings do not make the mesh fail.
#[test]
fn every_phase_can_be_meshed() {
    for step in 0..40 {
        let phase_mm = Some(1.905 * f64::from(step) / 40.0);
        let design = InfillDesign { phase_mm, direction_deg: f64::from(step), ..MIDDLE };
        let geometry = Geometry::new(&finray9(), &design).unwrap();
        let mesh = Mesh::new(&geometry.outer, &geometry.voids, 1.0 * MM).unwrap();
        assert!(mesh.triangles.len() < 8000, "{} at {design:?}", mesh.triangles.len());
    }
}

#[test]
fn shape_parameters_change_stiffness_and_area() {
    let middle = |change: fn(&mut PrintedFinger)| {
        let mut finger = finray9();
        change(&mut finger);
        Geometry::new(&finger, &MIDDLE).unwrap()
    };
    let plain = middle(|_| {});
    let ky = |geometry: &Geometry| compute(geometry).unwrap().pad.in_compliance();
    assert!(ky(&middle(|finger| finger.skin = 0.8 * MM)) > 1.1 * ky(&plain));
    assert!(ky(&middle(|finger| finger.ribs.thickness = 0.3 * MM)) < 0.8 * ky(&plain));
    assert!(ky(&middle(|finger| finger.outline.length += 5.0 * MM)) < 0.9 * ky(&plain));
    for changed in [
        middle(|finger| finger.outline.pad = 12.0 * MM),
        middle(|finger| finger.outline.back_radius = 30.0 * MM),
    ] {
        assert!((changed.area() / plain.area() - 1.0).abs() > 0.005);
    }
}

#[test]
fn errors_about_parts_that_do_not_fit_name_the_key() {
    type Change = fn(&mut PrintedFinger);
    let cases: [(&str, InfillDesign, Change); 12] = [
        ("ribs.thickness_mm", MIDDLE, |finger| finger.ribs.thickness = 2.0 * MM),
        ("ribs.thickness_mm", MIDDLE, |finger| finger.ribs.thickness = 0.1 * MM),
        ("skin.thickness_mm", MIDDLE, |finger| finger.skin = 5.0 * MM),
        ("notch.pad_mm", MIDDLE, |finger| finger.outline.pad = 32.0 * MM),
        ("notch.roof_mm", MIDDLE, |finger| finger.outline.roof = 5.0 * MM),
        ("outline.back_radius_mm", MIDDLE, |finger| finger.outline.back_radius = 9.0 * MM),
        ("outline.back_radius_mm", MIDDLE, |finger| finger.outline.back_radius = 400.0 * MM),
        ("outline.tip_mm", MIDDLE, |finger| finger.outline.tip = 16.0 * MM),
        ("base.clamped_mm", MIDDLE, |finger| finger.outline.clamped = 12.0 * MM),
        ("ribs.thickness_mm", InfillDesign { density_percent: 95.0, ..MIDDLE }, |_| {}),
        ("infill_density_percent", InfillDesign { density_percent: 0.0, ..MIDDLE }, |_| {}),
        ("infill_direction_deg", InfillDesign { direction_deg: 90.0, ..MIDDLE }, |_| {}),
    ];
    for (key, design, change) in cases {
        let mut finger = finray9();
        change(&mut finger);
        let error = Geometry::new(&finger, &design).unwrap_err().to_string();
        assert!(error.starts_with(&format!("fingers/finray9.toml: {key}: ")), "{error}");
    }
}

#[test]
fn a_picture_shows_every_opening_at_rest_and_under_load() {
    let geometry = infill(20.0, 20.0);
    let svg = picture::svg(&geometry).unwrap();
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    assert_eq!(svg.matches('Z').count(), 2 * (1 + geometry.voids.len()));
    assert!(svg.contains("displacements × "), "{svg}");
}
