//! Choice of the rigid notch for the elastic one: a plug that may touch or leave pad and roof, on the
//! elastic profile and on a rigid pad and roof with the springs of either condensation.

use super::infill;
use crate::condense::condense;
use crate::elasticity::{PlaneStress, Slab};
use crate::mechanics::{SIZE, planar};
use crate::meshed::{Follow, MeshedFinger};
use crate::stiffness::PlanarStiffness;
use input::units::MM;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Of all contact points of a face together, N/m: four points of the simulation.
const CONTACT: f64 = 4.0 * 0.55e6;

/// Points of pad and roof, and their motion with a plug that they stick to.
struct Faces {
    /// Two rows a point: y and z by the plug's y, z and rx.
    follow: DMatrix<f64>,
    on_roof: Vec<bool>,
    /// Stiffness of a point's contact, N/m.
    contact: Vec<f64>,
}

impl Faces {
    /// Motion of a plug under forces and a moment, against a finger of these shapes of its own motion
    /// and their stiffness; points that would pull let go.
    fn motion(
        &self,
        shapes: &DMatrix<f64>,
        stiffness: &DMatrix<f64>,
        load: Vector3<f64>,
    ) -> Vector3<f64> {
        let (count, own) = (self.on_roof.len(), shapes.ncols());
        // The finger's shapes, then the plug's three motions; apart = follow q - shapes u.
        let mut apart = DMatrix::zeros(2 * count, own + 3);
        apart.columns_mut(0, own).copy_from(&-shapes);
        apart.columns_mut(own, 3).copy_from(&self.follow);
        let mut active = vec![true; count];
        let mut answer = DVector::zeros(own + 3);
        for _ in 0..60 {
            let weight = DVector::from_fn(2 * count, |row, _| {
                if active[row / 2] { self.contact[row / 2] } else { 0.0 }
            });
            let mut system = apart.transpose() * DMatrix::from_diagonal(&weight) * &apart;
            let mut finger = system.view_mut((0, 0), (own, own));
            finger += stiffness;
            let mut force = DVector::zeros(own + 3);
            force.rows_mut(own, 3).copy_from(&load);
            answer = system.cholesky().expect("held").solve(&force);
            let gap = &apart * &answer;
            let presses = |i: usize| match self.on_roof[i] {
                true => gap[2 * i + 1] > 0.0,
                false => gap[2 * i] < 0.0,
            };
            let next: Vec<bool> = (0..count).map(presses).collect();
            if next == active {
                break;
            }
            active = next;
        }
        Vector3::new(answer[own], answer[own + 1], answer[own + 2])
    }
}

/// Springs at the remote centre without the pull of y and z on one another, as trials have them.
fn uncoupled(plane: &PlanarStiffness) -> Matrix3<f64> {
    let (s, c, kt) = (plane.centre_below_pad(), plane.centre_in_front(), plane.tilting());
    let at_centre = |k: f64, lever: f64| 1.0 / (1.0 / k - lever * lever / kt);
    let springs =
        Vector3::new(at_centre(plane.in_compliance(), s), at_centre(plane.in_assembly(), c), kt);
    let to_centre = Matrix3::new(1.0, 0.0, s, 0.0, 1.0, c, 0.0, 0.0, 1.0);
    to_centre.transpose() * Matrix3::from_diagonal(&springs) * to_centre
}

/// Mean error of the plug's motion (its turn at half a pad) as a share of the elastic one.
fn errors(density: f64, direction: f64) -> [f64; 4] {
    let geometry = infill(density, direction);
    let meshed = MeshedFinger::new(&geometry, SIZE).unwrap();
    let element = PlaneStress(Slab::of(&geometry.finger));
    let condensed = condense(&meshed.mesh, &element, &meshed.roles, false).unwrap();
    let outline = geometry.finger.outline;
    let (y, z) = (outline.out_of_pad(), outline.along_pad());
    let local = |&node: &u32| meshed.local(&meshed.mesh.nodes[node as usize]);
    let places: Vec<[f64; 2]> = condensed.nodes.iter().map(local).collect();
    let count = places.len();
    // From the profile's axes to y and z.
    let mut turn = DMatrix::zeros(2 * count, 2 * count);
    let mut follow = DMatrix::zeros(2 * count, 3);
    for (i, place) in places.iter().enumerate() {
        let rows = element.follow(&outline, *place);
        for d in 0..2 {
            (turn[(2 * i, 2 * i + d)], turn[(2 * i + 1, 2 * i + d)]) = (y[d], z[d]);
            for k in 0..3 {
                follow[(2 * i, k)] += y[d] * rows[d][k];
                follow[(2 * i + 1, k)] += z[d] * rows[d][k];
            }
        }
    }
    let elastic = &turn * &condensed.stiffness * turn.transpose();
    let on_roof: Vec<bool> = places.iter().map(|[y, _]| *y > 1e-6 * MM).collect();
    let roof = on_roof.iter().filter(|roof| **roof).count();
    let share =
        |roof_point: &bool| CONTACT / (if *roof_point { roof } else { count - roof }) as f64;
    let contact = on_roof.iter().map(share).collect();
    let faces = Faces { follow: follow.clone(), on_roof, contact };
    let free = DMatrix::identity(2 * count, 2 * count);
    let rigid = |stiffness: Matrix3<f64>| DMatrix::from_fn(3, 3, |i, j| stiffness[(i, j)]);
    let [pad, both] = planar(&geometry, SIZE).unwrap();
    let models = [uncoupled(&pad), uncoupled(&both), *pad.matrix(), *both.matrix()].map(rigid);
    let half = outline.pad / 2.0;
    // Pressed by the grasp; pushed up or not; turned in the grasp either way.
    let loads = [0.0, 10.0]
        .into_iter()
        .flat_map(|up| [-0.01, 0.0, 0.01].map(|moment| Vector3::new(-5.0, up, moment)));
    let loads: Vec<Vector3<f64>> = loads.collect();
    let scaled = |motion: Vector3<f64>| Vector3::new(motion.x, motion.y, motion.z * half);
    models.map(|stiffness| {
        let error = |load: &Vector3<f64>| {
            let truth = faces.motion(&free, &elastic, *load);
            let found = faces.motion(&follow, &stiffness, *load);
            (scaled(found) - scaled(truth)).norm() / scaled(truth).norm()
        };
        loads.iter().map(error).sum::<f64>() / loads.len() as f64
    })
}

/// Pressed, pushed up and turned by loads that a grasp of 5 N holds, the elastic finger moves more
/// like the springs of pad and roof than like those of the pad; the pull of y and z on one
/// another counts for more than that choice.
#[test]
fn springs_of_pad_and_roof_answer_a_plug_more_like_the_elastic_finger() {
    for (density, direction) in [(10.0, 0.0), (20.0, 20.0), (30.0, 40.0)] {
        let [pad, both, pad_coupled, both_coupled] = errors(density, direction);
        assert!(
            both < pad && both_coupled < pad_coupled && pad_coupled < both,
            "{density} {direction}: {pad:.3} {both:.3} {pad_coupled:.3} {both_coupled:.3}"
        );
    }
}
