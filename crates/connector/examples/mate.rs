//! Prints the mates of two meshes: `mate PLUG SOCKET [UNIT_M]`.
#![allow(clippy::print_stdout, clippy::unwrap_used)]
use connector::mating::{Found, Watch, mates};
use connector::mesh::{Triangle, read};

fn triangles(path: &str, unit: f64) -> Vec<Triangle> {
    let bodies = read(&std::fs::read(path).unwrap(), path).unwrap();
    let all = bodies.into_iter().flat_map(|body| body.triangles);
    all.map(|corners| corners.map(|p| p * unit)).collect()
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let unit: f64 = args.get(3).map_or(1e-3, |unit| unit.parse().unwrap());
    let (plug, socket) = (triangles(&args[1], unit), triangles(&args[2], unit));
    let start = std::time::Instant::now();
    let found = mates(&plug, &socket, &Watch::NONE);
    println!("# {:.1} s", start.elapsed().as_secs_f64());
    let list = match found {
        Ok(Found::One(mate)) => { println!("# one"); vec![mate] }
        Ok(Found::Symmetric(mate, count)) => { println!("# symmetric {count}"); vec![mate] }
        Ok(Found::Ambiguous(mates)) => { println!("# ambiguous"); mates }
        Err(error) => { println!("# {error}"); vec![] }
    };
    for m in list.iter().take(12) {
        println!(
            "out {:.3?} deep {:.3} play {:.3?} yaw {:.3} deg overlap {:.3} walls {:.3} mm2 through {}",
            m.out.as_slice(), m.engaged_m * 1e3, m.play_m.map(|v| v * 1e3), m.yaw_rad.to_degrees(),
            m.overlap_m * 1e3, m.walls_m2 * 1e6, m.through
        );
        println!("pose {:?}", m.pose.to_homogeneous().as_slice());
    }
}
