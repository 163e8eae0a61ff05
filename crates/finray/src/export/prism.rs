//! A profile extruded along the finger's depth: a closed surface of triangles, as STL and 3MF files.

use super::rings;
use crate::geometry::Geometry;
use crate::mesh::Mesh;
use crate::polygon::{self, Ring};
use input::units::MM;
use maud::html;
use nalgebra::{Point2, Vector3};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Cursor, Write};
use zip::CompressionMethod;
use zip::result::ZipResult;
use zip::write::{SimpleFileOptions, ZipWriter};

/// Closed surface, with coordinates in the precision of the files, so that the checks apply to the files.
#[derive(Debug, Clone, PartialEq)]
pub struct Prism {
    /// Corners, mm.
    pub corners: Vec<[f32; 3]>,
    /// Corners of each triangle, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Reason why there is no closed surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct PrismError(pub(super) String);

/// Largest relative difference between the volume and area times depth.
const VOLUME_TOLERANCE: f64 = 1e-3;
/// Length of the header of an STL file, bytes.
const HEADER: usize = 80;

pub(super) const DECLARATION: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;

const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rel-1" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

impl Prism {
    /// Returns the checked surface of the finger with its ribs.
    ///
    /// # Errors
    /// If the surface is not closed, or its volume differs from area times depth.
    pub fn finger(geometry: &Geometry) -> Result<Self, PrismError> {
        let rings = rings(geometry);
        Prism::new(&rings[0], &rings[1..], geometry.finger.outline.depth / MM)?.with_block(geometry)
    }

    /// Returns the checked surface of the finger without openings, for slicers that fill it with their own infill.
    ///
    /// # Errors
    /// See [`Prism::finger`].
    pub fn outline(geometry: &Geometry) -> Result<Self, PrismError> {
        let rings = rings(geometry);
        let holes = &rings[1 + geometry.voids.len()..];
        Prism::new(&rings[0], holes, geometry.finger.outline.depth / MM)?.with_block(geometry)
    }

    /// Returns the surface of the solid base, where a slicer's infill has to be full.
    ///
    /// # Errors
    /// See [`Prism::finger`].
    pub fn base(geometry: &Geometry) -> Result<Self, PrismError> {
        let outline = &geometry.finger.outline;
        let (start, end) = ((outline.length - outline.solid) / MM, outline.length / MM);
        let width = outline.width / MM;
        let block = [[start, 0.0], [end, 0.0], [end, width], [start, width]];
        Prism::new(&block.map(Point2::from).to_vec(), &[], outline.depth / MM)?.with_block(geometry)
    }

    /// Adds the block with the finger's holes, if there is one: a separate closed surface that overlaps the finger.
    /// The union of both is solid (3MF Core Specification 1.3, 4.1: the positive fill rule); slicers read STL files
    /// in the same way.
    fn with_block(self, geometry: &Geometry) -> Result<Self, PrismError> {
        let Some((holes, block)) = geometry.block() else { return Ok(self) };
        let outline = &geometry.finger.outline;
        let [u, v] = holes.axis.across().map(|direction| direction as usize);
        let axis = holes.axis as usize;
        let origin = [0.0, outline.width / MM, 0.0];
        let mut ends = holes.carrier(outline);
        ends[0][0] -= block.overlap;
        let placed = |x: f64, y: f64| Point2::new(x / MM + origin[u], y / MM + origin[v]);
        let [[left, right], [low, high]] = [ends[u], ends[v]];
        let outer = [[left, low], [right, low], [right, high], [left, high]];
        let rings = holes.rings(outline).into_iter();
        let rings: Vec<Ring> =
            rings.map(|ring| ring.iter().map(|p| placed(p.x, p.y)).collect()).collect();
        let [start, end] = ends[axis].map(|end| end / MM + origin[axis]);
        let outer = outer.map(|[x, y]| placed(x, y)).to_vec();
        let mut block = Prism::new(&outer, &rings, end - start)?;
        for corner in &mut block.corners {
            let [x, y, z] = *corner;
            (corner[u], corner[v], corner[axis]) = (x, y, z + start as f32);
        }
        self.merged(&block).closed()
    }

    /// Extrudes an outer ring with holes (clockwise rings) from 0 to `depth`, mm.
    fn new(outer: &Ring, holes: &[Ring], depth: f64) -> Result<Self, PrismError> {
        let mesh = Mesh::coarsest(outer, holes).map_err(|error| PrismError(error.to_string()))?;
        let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
        let mut corners = Vec::new();
        let mut number = |node: u32| {
            *numbers.entry(node).or_insert_with(|| {
                let place = mesh.nodes[node as usize];
                let [x, y] = [place.x, place.y].map(|value| value as f32);
                corners.extend([[x, y, 0.0], [x, y, depth as f32]]);
                corners.len() as u32 - 2
            })
        };
        let below: Vec<[u32; 3]> =
            mesh.triangles.iter().map(|&[a, b, c, ..]| [a, b, c].map(&mut number)).collect();
        let mut triangles: Vec<[u32; 3]> = below.iter().map(|&[a, b, c]| [a, c, b]).collect();
        triangles.extend(below.iter().map(|corners| corners.map(|corner| corner + 1)));
        let edges: BTreeSet<[u32; 2]> = below.iter().flat_map(sides).collect();
        let rim = edges.iter().filter(|[a, b]| !edges.contains(&[*b, *a]));
        triangles.extend(rim.flat_map(|&[a, b]| [[a, b, b + 1], [a, b + 1, a + 1]]));
        let prism = Prism { corners, triangles }.closed()?;
        let area = polygon::area(outer) + holes.iter().map(|hole| polygon::area(hole)).sum::<f64>();
        let (volume, expected) = (prism.volume(), area * depth);
        if (volume - expected).abs() > VOLUME_TOLERANCE * expected {
            let problem =
                format!("the volume is {volume:.1} mm3; area times depth is {expected:.1} mm3");
            return Err(PrismError(problem));
        }
        Ok(prism)
    }

    /// Returns the surface if it is closed: each edge belongs to two triangles, once in each direction. Corners are
    /// identified by their positions, as in an STL file, which does not number them.
    fn closed(self) -> Result<Self, PrismError> {
        let place = |corner: u32| self.corners[corner as usize].map(f32::to_bits);
        let mut counts: BTreeMap<[[u32; 3]; 2], i32> = BTreeMap::new();
        for [a, b] in self.triangles.iter().flat_map(sides) {
            *counts.entry([place(a), place(b)]).or_default() += 1;
        }
        let twice =
            |[a, b]: &[[u32; 3]; 2]| counts[&[*a, *b]] == 1 && counts.get(&[*b, *a]) == Some(&1);
        match counts.keys().filter(|edge| !twice(edge)).count() {
            0 => Ok(self),
            open => Err(PrismError(format!("{open} edges do not belong to exactly two triangles"))),
        }
    }

    /// Returns the volume that the surface encloses, mm3.
    fn volume(&self) -> f64 {
        let sixth = |triangle: &[u32; 3]| {
            let [a, b, c] = self.places(triangle);
            a.dot(&b.cross(&c)) / 6.0
        };
        self.triangles.iter().map(sixth).sum()
    }

    /// Returns the positions of the corners of a triangle, mm.
    fn places(&self, triangle: &[u32; 3]) -> [Vector3<f64>; 3] {
        triangle.map(|corner| self.corners[corner as usize].map(f64::from).into())
    }

    /// Returns a binary STL file, mm, with a title in its header.
    pub fn stl(&self, title: &str) -> Vec<u8> {
        let mut out = format!("finger-opt: {title}; mm").into_bytes();
        out.resize(HEADER, b' ');
        out.extend((self.triangles.len() as u32).to_le_bytes());
        for triangle in &self.triangles {
            let [a, b, c] = self.places(triangle);
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
            let corners = triangle.iter().flat_map(|&corner| self.corners[corner as usize]);
            for value in normal.iter().map(|&n| n as f32).chain(corners) {
                out.extend(value.to_le_bytes());
            }
            out.extend([0, 0]);
        }
        out
    }

    /// Returns a 3MF file, mm: a zip by the 3MF Core Specification 1.3.
    ///
    /// # Errors
    /// If the zip cannot be written.
    pub fn three_mf(&self, title: &str) -> ZipResult<Vec<u8>> {
        three_mf(&[self], title, &[])
    }

    /// Returns both surfaces as one; the triangles of the other follow those of this one.
    pub(super) fn merged(mut self, other: &Prism) -> Self {
        let first = self.corners.len() as u32;
        self.corners.extend(&other.corners);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|corner| corner + first)));
        self
    }
}

/// Returns a 3MF file, mm, with `more` text files (name, content). Several surfaces are the components 1, 2, ... of an
/// object with the next id.
pub(super) fn three_mf(parts: &[&Prism], title: &str, more: &[(&str, &str)]) -> ZipResult<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let files = [
        ("[Content_Types].xml", TYPES),
        ("_rels/.rels", RELATIONS),
        ("3D/3dmodel.model", &*model(parts, title)),
    ];
    // The entries have the earliest date of the zip format, so that equal contents give equal files.
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for &(name, text) in files.iter().chain(more) {
        zip.start_file(name, options)?;
        zip.write_all(text.as_bytes())?;
    }
    Ok(zip.finish()?.into_inner())
}

/// Returns the id of the object in [`three_mf`] that contains all surfaces, given their number.
pub(super) fn object_id(parts: usize) -> usize {
    if parts == 1 { 1 } else { parts + 1 }
}

fn model(parts: &[&Prism], title: &str) -> String {
    let whole = object_id(parts.len());
    let model = html! {
        model unit="millimeter" xml:lang="en-US"
            xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
            xmlns:slic3rpe="http://schemas.slic3r.org/3mf/2017/06" {
            metadata name="slic3rpe:Version3mf" { "1" }
            metadata name="Title" { (title) }
            metadata name="Application" { "finger-opt " (env!("CARGO_PKG_VERSION")) }
            resources {
                @for (n, part) in (1..).zip(parts) {
                    object id=(n) type="model" name=(title) {
                        mesh {
                            vertices {
                                @for [x, y, z] in &part.corners { vertex x=(x) y=(y) z=(z) {} }
                            }
                            triangles {
                                @for [a, b, c] in &part.triangles { triangle v1=(a) v2=(b) v3=(c) {} }
                            }
                        }
                    }
                }
                @if whole > parts.len() {
                    object id=(whole) type="model" name=(title) {
                        components { @for n in 1..whole { component objectid=(n) {} } }
                    }
                }
            }
            build { item objectid=(whole) {} }
        }
    };
    DECLARATION.to_owned() + &model.into_string()
}

/// Returns the directed edges of a triangle.
fn sides(&[a, b, c]: &[u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}
