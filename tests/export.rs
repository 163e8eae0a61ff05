//! Export of fingers: closed solids of the right volume, files that other programs read, and the
//! ribs of the design in PrusaSlicer's layers.

use crate::common::{Studies, optimize_line, read};
use finray::export::prism::Prism;
use finray::export::sheet::{self, SheetData};
use finray::export::slicer;
use finray::geometry::Geometry;
use finray::infill::InfillDesign;
use finray::mechanics;
use finray::printed::PrintedFinger;
use nalgebra::Matrix3;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// The shipped finger with an infill.
fn finray9(density_percent: f64, direction_deg: f64) -> Geometry {
    holed(density_percent, direction_deg, "")
}

/// The same with what is added to its file.
fn holed(density_percent: f64, direction_deg: f64, holes: &str) -> Geometry {
    let text = include_str!("../fingers/finray9.toml").to_owned() + holes;
    let finger = PrintedFinger::parse(&text, "finray9.toml").expect("the shipped finger");
    let design = InfillDesign { density_percent, direction_deg, phase_mm: None };
    Geometry::new(&finger, &design).expect("a finger that can be printed")
}

/// Corners of the triangles of a binary STL file.
fn triangles(bytes: &[u8]) -> Vec<[[f32; 3]; 3]> {
    let count = u32::from_le_bytes(bytes[80..84].try_into().expect("4 bytes")) as usize;
    assert_eq!(bytes.len(), 84 + 50 * count);
    let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().expect("4 bytes"));
    let corner = |at: usize| [0, 4, 8].map(|axis| number(at + axis));
    (0..count).map(|i| [12, 24, 36].map(|at| corner(84 + 50 * i + at))).collect()
}

/// Read back from the file by code of its own.
#[test]
fn a_solid_is_closed_and_has_area_times_depth() {
    let plain = [(10.0, 0.0), (18.0, 20.0), (30.0, 40.0), (25.0, -30.0)];
    let block = "[holes.block]\nlength_mm = 12.0\nwidth_mm = 24.0\noverlap_mm = 1.5\n";
    // The block with its holes, mm3: of polygons of 32 corners.
    let hole = 16.0 * 1.6f64.powi(2) * libm::sin((360f64 / 32.0).to_radians());
    let [across, along] = [24.0, 13.5].map(|deep| 13.5 * 24.0 * 12.0 - 2.0 * deep * hole);
    let holes = [("depth", "width", "", 0.0), ("width", "length", block, across)];
    let holes = holes.into_iter().chain([("length", "width", block, along)]);
    let holed = holes.map(|(axis, row, block, more)| {
        let of = format!("axis = '{axis}'\nrow = '{row}'\ncount = 2\ndiameter_mm = 3.2");
        let holes = format!("[holes]\n{of}\nspacing_mm = 5.0\noffset_mm = [0.0, 0.0]\n{block}");
        (holed(18.0, 20.0, &holes), more)
    });
    for (geometry, more) in plain.map(|(a, b)| (finray9(a, b), 0.0)).into_iter().chain(holed) {
        let design = geometry.design;
        let triangles = triangles(&Prism::finger(&geometry).unwrap().stl("test"));
        let mut edges: BTreeMap<[[u32; 3]; 2], u32> = BTreeMap::new();
        let sixth =
            |t: &[[f32; 3]; 3]| Matrix3::from(t.map(|p| p.map(f64::from))).determinant() / 6.0;
        let volume: f64 = triangles.iter().map(sixth).sum();
        for [a, b, c] in triangles.iter().map(|t| t.map(|p| p.map(f32::to_bits))) {
            for edge in [[a, b], [b, c], [c, a]] {
                *edges.entry(edge).or_default() += 1;
            }
        }
        for ([a, b], count) in &edges {
            assert_eq!((*count, edges.get(&[*b, *a])), (1, Some(&1)), "{design:?}");
        }
        let expected = geometry.area() * 0.012 * 1e9 + more;
        assert!((volume / expected - 1.0).abs() < 1e-3, "{volume} for {expected} mm3");
    }
}

/// The first element of a name in a text, parsed.
fn document<'a>(text: &'a str, name: &str) -> roxmltree::Document<'a> {
    let (start, end) = (format!("<{name}"), format!("</{name}>"));
    let element = &text[text.find(&start).unwrap()..text.find(&end).unwrap() + end.len()];
    roxmltree::Document::parse(element).unwrap()
}

#[test]
fn a_3mf_is_a_zip_of_a_model_in_millimetres() {
    let prism = Prism::finger(&finray9(18.0, 20.0)).unwrap();
    let bytes = prism.three_mf("a < b").unwrap();
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.starts_with("PK") && text.contains("[Content_Types].xml"));
    let model = document(&text, "model");
    let count = |name| model.descendants().filter(|node| node.has_tag_name(name)).count();
    let core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
    assert_eq!(model.root_element().attribute("unit"), Some("millimeter"));
    assert_eq!(count((core, "vertex")), prism.corners.len());
    assert_eq!(count((core, "triangle")), prism.triangles.len());
}

/// The parts of the settings are components of the built object, and every setting of PrusaSlicer has its like.
#[test]
fn a_3mf_for_orcaslicer_names_the_parts_of_its_model() {
    let geometry = finray9(18.0, 20.0);
    let bytes = slicer::orcaslicer_project(&geometry).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    let (model, config) = (document(&text, "model"), document(&text, "config"));
    let all = |document: &roxmltree::Document<'_>, name: &str, attribute: &str| {
        let nodes = document.descendants().filter(|node| node.tag_name().name() == name);
        nodes.map(|node| node.attribute(attribute).unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(all(&model, "item", "objectid"), all(&config, "object", "id"));
    assert_eq!(all(&model, "component", "objectid"), all(&config, "part", "id"));
    assert_eq!(all(&model, "object", "id"), ["1", "2", "3"]);
    assert_eq!(all(&config, "part", "subtype"), ["normal_part", "modifier_part"]);
    let value = |key: &str| {
        let mut nodes = config.descendants();
        let node = nodes.find(|node| node.attribute("key") == Some(key));
        node.unwrap_or_else(|| panic!("{key}")).attribute("value").unwrap().to_owned()
    };
    let prusa = slicer::settings(&geometry);
    for (prusa_key, key) in [
        ("fill_density", "sparse_infill_density"),
        ("fill_angle", "infill_direction"),
        ("fill_pattern", "sparse_infill_pattern"),
        ("perimeters", "wall_loops"),
        ("perimeter_extrusion_width", "inner_wall_line_width"),
    ] {
        let same = |(own, _, set): &(&str, &str, String)| *own == prusa_key && *set == value(key);
        assert!(prusa.iter().any(same), "{key}");
    }
    assert!(!text.contains("PrusaSlicer"), "OrcaSlicer would drop the settings");
    let ribs = &mechanics::compute(&geometry).unwrap();
    let sheet = sheet::svg(&geometry, &SheetData { origin: "", ribs, measured: None });
    let [density, angle] = ["sparse_infill_density", "infill_direction"].map(value);
    let [walls, wall] = ["wall_loops", "inner_wall_line_width"].map(value);
    for set in [format!("{density}, {angle}° from X"), format!("walls {walls} × {wall}<")] {
        assert!(sheet.contains(&set), "{set}");
    }
}

#[test]
fn every_format_of_a_studys_best_finger_is_written() {
    let studies = Studies::new();
    studies.study("usb", 4, &["--task", "usb"]).succeeds();
    let (study, folder) = (studies.dir("usb"), studies.dir("prints"));
    let export = |format: &str, file: &str| {
        let (study, out) = (study.display(), folder.join(file));
        optimize_line(&format!("export finger {study} --format {format} --out {}", out.display()))
    };
    for (format, file, words) in [
        ("dxf", "f.dxf", "POLYLINE"),
        ("sheet", "sheet.html", "PETG"),
        ("stl", "f.stl", ""),
        ("3mf", "f.3mf", ""),
        ("prusaslicer-3mf", "prusa.3mf", "Slic3r_PE_model.config"),
        ("orcaslicer-3mf", "orca.3mf", "model_settings.config"),
    ] {
        let ran = export(format, file);
        ran.succeeds();
        // The headline of the study is another finger.
        for words in ["recommended by simulation", "--density 30 --direction 20 instead of "] {
            assert!(ran.stderr.contains(words), "{}", ran.stderr);
        }
        assert!(!ran.stderr.contains("unfinished"), "{}", ran.stderr);
        let written = std::fs::read(folder.join(file)).unwrap();
        if !format.ends_with("-3mf") {
            let out = folder.join(file);
            optimize_line(&format!("export finger {} --out {}", study.display(), out.display()))
                .succeeds();
            assert!(written == std::fs::read(out).unwrap(), "{file}: another format by its ending");
        }
        let text = String::from_utf8_lossy(&written);
        assert!(text.contains(words), "{file}");
        if format == "sheet" {
            document(&text, "svg");
            assert!(text.contains("N/mm, measured model") && text.contains("N/mm, from the ribs"));
        }
    }
    let longer = studies.read("usb/study.toml").replace("budget = 4", "budget = 5");
    studies.file("usb/study.toml", longer);
    let ran = export("dxf", "f.dxf");
    ran.succeeds();
    assert!(ran.stderr.contains("unfinished: optimize resume "), "{}", ran.stderr);
    export("sheet", "sheet.pdf").fails(2, &["sheet.pdf", "must end in .html or .htm"]);
    export("stl", "f.3MF").fails(2, &["--format stl", "f.3MF", "must end in .stl"]);
    export("prusaslicer-3mf", "f.gcode").fails(2, &["f.gcode", "must end in .3mf"]);
    export("sheet", "f.svg").fails(2, &["--format sheet", "must end in .html or .htm"]);
    export("dxf", "f.html").fails(2, &["--format dxf", "must end in .dxf"]);
    optimize_line(&format!("export finger {} --out f.txt", study.display()))
        .fails(2, &["--out f.txt", "must end in one of .3mf, .dxf, .htm"]);
    let finger = include_str!("../fingers/finray9.toml").replace("data/measured", "none");
    let finger = studies.file("finger.toml", &finger);
    for command in
        ["finger", &format!("export finger --format sheet --out {}/s.html", folder.display())]
    {
        let line = format!("{command} --density 20 --direction 20 --finger {finger}");
        optimize_line(&line).fails(2, &["none_stiffness.csv"]);
    }
}

#[test]
fn what_cannot_be_exported_is_told() {
    for (words, parts) in [
        ("", &["DIR"][..]),
        ("--density 20", &["--direction"]),
        ("--density 95 --direction 0", &["finray9.toml", "ribs.thickness_mm", "at most"]),
        ("nowhere", &["nowhere"]),
    ] {
        let export = format!("export finger --format stl --out none.stl {words}");
        optimize_line(&export).fails(2, parts);
    }
    assert!(!Path::new("none.stl").exists());
}

/// A straight extrusion: from x, y to x, y, mm.
type Line = [f64; 4];

/// Extrusions of PrusaSlicer in the middle layer of a file.
fn middle_layer(folder: &Path, file: &str) -> Vec<Line> {
    let gcode = folder.join("sliced.gcode");
    let mut slicer = Command::new("prusa-slicer");
    slicer.arg("--export-gcode").arg(folder.join(file)).arg("--output").arg(&gcode);
    let ran = slicer.args(["--layer-height", "0.2", "--skirts", "0"]).output().unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let text = read(&gcode);
    let layers: Vec<&str> = text.split(";LAYER_CHANGE").skip(1).collect();
    let (mut at, mut lines) = ([0.0, 0.0], Vec::new());
    for words in layers[layers.len() / 2].lines().filter(|line| line.starts_with("G1 ")) {
        let value = |axis: char| {
            let word = words.split_whitespace().find(|word| word.starts_with(axis))?;
            word[1..].parse::<f64>().ok()
        };
        let to = [value('X').unwrap_or(at[0]), value('Y').unwrap_or(at[1])];
        if to != at && value('E').is_some() {
            lines.push([at[0], at[1], to[0], to[1]]);
        }
        at = to;
    }
    lines
}

/// Positions of the lines of a direction across them, mm: one for all within 0.6 mm. Only lines in
/// the ribbed part count.
fn ribs(lines: &[Line], direction_deg: f64) -> Vec<f64> {
    let (sin, cos) = libm::sincos(direction_deg.to_radians());
    let start = lines.iter().map(|line| line[0].min(line[2])).fold(f64::MAX, f64::min);
    let across = lines.iter().filter_map(|&[x, y, to_x, to_y]| {
        let length = libm::hypot(to_x - x, to_y - y);
        let turned = ((to_x - x) * cos - (to_y - y) * sin).abs() / length;
        let ribbed = (x + to_x) / 2.0 - start < 52.8 - 10.75 - 0.5;
        (length > 0.3 && turned < 0.03 && ribbed).then_some(x * cos - y * sin)
    });
    let mut across: Vec<f64> = across.collect();
    across.sort_by(f64::total_cmp);
    across.dedup_by(|next, before| *next - *before < 0.6);
    across
}

fn assert_pitch(ribs: &[f64], geometry: &Geometry) {
    let same = |pair: &[f64]| (pair[1] - pair[0] - geometry.lines.pitch * 1e3).abs() < 0.02;
    assert!(ribs.windows(2).all(same), "{ribs:?} of {:?}", geometry.design);
}

#[test]
fn prusaslicer_prints_the_ribs_of_the_design() {
    if Command::new("prusa-slicer").arg("--help").output().is_err() {
        eprintln!("left out: slicing, for want of prusa-slicer (scripts/tools.sh prusa-slicer)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    // The best designs of rj45, usb and the keys, and the densest.
    for (density, direction) in [(18.0, 20.0), (10.0, 7.0), (10.0, 0.0), (30.0, 40.0)] {
        let geometry = finray9(density, direction);
        write("finger.stl", &Prism::finger(&geometry).unwrap().stl(""));
        let found = ribs(&middle_layer(folder.path(), "finger.stl"), direction);
        assert_eq!(found.len(), geometry.ribs, "{density} %, {direction}°: {found:?}");
        assert_pitch(&found, &geometry);
    }
}

/// One 3MF with the settings of the object: no option of the slicer, direction and pitch of twelve designs, and a
/// solid base.
#[test]
fn a_3mf_with_settings_is_printed_as_designed() {
    if Command::new("prusa-slicer").arg("--help").output().is_err() {
        eprintln!("left out: slicing, for want of prusa-slicer (scripts/tools.sh prusa-slicer)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for density in [10.0, 16.0, 23.0, 30.0] {
        for direction in [0.0, 14.0, 40.0] {
            let geometry = finray9(density, direction);
            let project = slicer::prusaslicer_project(&geometry).unwrap();
            std::fs::write(folder.path().join("finger.3mf"), project).unwrap();
            let lines = middle_layer(folder.path(), "finger.3mf");
            let start = lines.iter().map(|line| line[0].min(line[2])).fold(f64::MAX, f64::min);
            let end = lines.iter().map(|line| line[0].max(line[2])).fold(f64::MIN, f64::max);
            // Turned from Y to X, of what lies across the finger in its ribbed part.
            let turned = |&[x, y, to_x, to_y]: &Line| {
                let (dx, dy) = if to_y > y { (to_x - x, to_y - y) } else { (x - to_x, y - to_y) };
                let across = dy > 2.0 && (x + to_x) / 2.0 - start < 40.0;
                across.then_some(libm::atan2(dx, dy).to_degrees())
            };
            let mut angles: Vec<f64> = lines.iter().filter_map(turned).collect();
            angles.sort_by(f64::total_cmp);
            let angle = angles[angles.len() / 2];
            assert!((angle - direction).abs() < 1.0, "{density} %, {direction}°: {angle}°");
            let found = ribs(&lines, direction);
            let pitch = (found[found.len() - 1] - found[0]) / (found.len() - 1) as f64;
            let share = pitch / (geometry.lines.pitch * 1e3);
            assert!((share - 1.0).abs() < 0.05, "{density} %, {direction}°: {pitch} mm");
            // The base is as full as lines of 0.4 mm side by side make it.
            let solid = |[x, y, to_x, to_y]: &Line| {
                let inside = end - (x + to_x) / 2.0 < 9.0;
                if inside { libm::hypot(to_x - x, to_y - y) } else { 0.0 }
            };
            let area = 0.4 * lines.iter().map(solid).sum::<f64>();
            let width = geometry.finger.outline.width * 1e3;
            assert!(area > 0.8 * 9.0 * width, "{density} %, {direction}°: {area} mm2");
        }
    }
}
