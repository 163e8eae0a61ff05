//! A recorded trial as a glTF 2.0 binary (Khronos Group, glTF 2.0 Specification, 2021): bodies as
//! meshes, their motion as an animation. Metres, seconds; y up as glTF has it, by a node that turns.

use super::Film;
use super::film::{bodies, thinned};
use crate::physics::surface;
use crate::scene::{Geom, Pose};
use crate::trial::record::Frame;
use serde_json::{Value, json};

/// Time between two keys of the animation, s.
const INTERVAL: f64 = 2e-3;
const FLOAT: u32 = 5126;
const UNSIGNED: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
/// What the chunks of the file are: `JSON` and `BIN`.
const CHUNKS: [u32; 2] = [0x4E4F_534A, 0x004E_4942];
/// `glTF`.
const MAGIC: u32 = 0x4654_6C67;

/// The numbers of a file, and how they are to be read.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Keeps numbers of four bytes each and gives the index of their accessor.
    fn add(&mut self, bytes: Vec<u8>, target: Option<u32>, accessor: Value) -> usize {
        let mut view =
            json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = target.into();
        }
        let mut accessor = accessor;
        accessor["bufferView"] = self.views.len().into();
        self.bytes.extend(bytes);
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn floats(&mut self, values: &[f32], kind: &str, width: usize, target: Option<u32>) -> usize {
        let column = |at: usize| values.iter().skip(at).step_by(width).copied();
        let bound = |pick: fn(f32, f32) -> f32, start: f32| -> Vec<f32> {
            (0..width).map(|at| column(at).fold(start, pick)).collect()
        };
        let accessor = json!({
            "componentType": FLOAT,
            "type": kind,
            "count": values.len() / width,
            "min": bound(f32::min, f32::INFINITY),
            "max": bound(f32::max, f32::NEG_INFINITY),
        });
        self.add(values.iter().flat_map(|value| value.to_le_bytes()).collect(), target, accessor)
    }

    fn indices(&mut self, values: &[u32]) -> usize {
        let accessor = json!({"componentType": UNSIGNED, "type": "SCALAR", "count": values.len()});
        let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.add(bytes, Some(INDICES), accessor)
    }
}

/// The file.
pub fn glb(film: &Film) -> Vec<u8> {
    let frames = thinned(&film.recording.frames, INTERVAL);
    let mut buffer = Buffer::default();
    let times: Vec<f32> = frames.iter().map(|frame| frame.time_s as f32).collect();
    let input = buffer.floats(&times, "SCALAR", 1, None);
    let (mut nodes, mut meshes) = (Vec::new(), Vec::new());
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    for (kind, of, geoms) in bodies(film) {
        let material = MATERIALS.iter().position(|(name, _)| *name == kind).unwrap_or_default();
        let node = nodes.len();
        meshes.push(json!({"name": of, "primitives": primitives(&mut buffer, &geoms, material)}));
        nodes.push(json!({"name": of, "mesh": meshes.len() - 1}));
        let Some(pose) = pose_of(of) else { continue };
        let poses: Vec<Pose> = frames.iter().map(|frame| pose(frame)).collect();
        let moved: Vec<f32> = poses
            .iter()
            .flat_map(|p| <[f64; 3]>::from(p.translation.vector))
            .map(|v| v as f32)
            .collect();
        let turned: Vec<f32> = poses
            .iter()
            .flat_map(|p| <[f64; 4]>::from(p.rotation.coords))
            .map(|v| v as f32)
            .collect();
        for (path, output) in [
            ("translation", buffer.floats(&moved, "VEC3", 3, None)),
            ("rotation", buffer.floats(&turned, "VEC4", 4, None)),
        ] {
            channels
                .push(json!({"sampler": samplers.len(), "target": {"node": node, "path": path}}));
            samplers.push(json!({"input": input, "output": output, "interpolation": "LINEAR"}));
        }
    }
    // From z up to y up: a quarter turn about x.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let children: Vec<usize> = (0..nodes.len()).collect();
    nodes.push(json!({"name": "task", "rotation": [-half, 0.0, 0.0, half], "children": children}));
    let document = json!({
        "asset": {"version": "2.0", "generator": concat!("finger-opt ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"name": film.task.name, "nodes": [nodes.len() - 1]}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials(),
        "animations": [{"name": film.label, "samplers": samplers, "channels": channels}],
        "buffers": [{"byteLength": buffer.bytes.len()}],
        "bufferViews": buffer.views,
        "accessors": buffer.accessors,
    });
    file(document.to_string().into_bytes(), buffer.bytes)
}

fn pose_of(name: &str) -> Option<fn(&Frame) -> Pose> {
    match name {
        "plug" => Some(|frame| frame.poses.plug),
        "latch" => Some(Frame::latch),
        "finger0" => Some(|frame| frame.poses.fingers[0]),
        "finger1" => Some(|frame| frame.poses.fingers[1]),
        _ => None,
    }
}

/// Colour of each kind of the [`bodies`]: red, green, blue, opacity.
const MATERIALS: [(&str, [f64; 4]); 3] = [
    ("socket", [0.27, 0.37, 0.57, 0.4]),
    ("plug", [0.81, 0.37, 0.05, 1.0]),
    ("finger", [0.09, 0.3, 0.11, 1.0]),
];

fn materials() -> Vec<Value> {
    let one = |(name, colour): (&str, [f64; 4])| {
        let mut material = json!({
            "name": name,
            "pbrMetallicRoughness":
                {"baseColorFactor": colour, "metallicFactor": 0.0, "roughnessFactor": 0.8},
        });
        if colour[3] < 1.0 {
            material["alphaMode"] = "BLEND".into();
        }
        material
    };
    MATERIALS.into_iter().map(one).collect()
}

/// A triangle list of each shape; without normals viewers shade it flat.
fn primitives(buffer: &mut Buffer, geoms: &[Geom], material: usize) -> Vec<Value> {
    let mut one = |geom: &Geom| {
        let found = surface(&geom.shape);
        let points: Vec<f32> = found
            .points
            .iter()
            .flat_map(|point| <[f64; 3]>::from((geom.pose * point).coords))
            .map(|metres| metres as f32)
            .collect();
        if points.is_empty() {
            return None;
        }
        let indices: Vec<u32> = found.triangles.into_iter().flatten().collect();
        let position = buffer.floats(&points, "VEC3", 3, Some(VERTICES));
        Some(json!({
            "attributes": {"POSITION": position},
            "indices": buffer.indices(&indices),
            "material": material,
        }))
    };
    geoms.iter().filter_map(&mut one).collect()
}

/// Header and chunks; each chunk is filled up to a multiple of four bytes.
fn file(mut json: Vec<u8>, mut bytes: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let length = 12 + 8 + json.len() + 8 + bytes.len();
    let mut file = Vec::with_capacity(length);
    for word in [MAGIC, 2, length as u32] {
        file.extend(word.to_le_bytes());
    }
    for (kind, chunk) in CHUNKS.into_iter().zip([json, bytes]) {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind.to_le_bytes());
        file.extend(chunk);
    }
    file
}
