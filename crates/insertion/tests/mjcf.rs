//! Contents of the models, read back as XML.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use contact::mjcf::*;
use contact::scene::*;
use input::shipped::{COMMERCIAL, ROBOTS, Shipped, TASKS};
use input::units::N_PER_MM;
use insertion::finger::Finger;
use insertion::robot::Robot;
use insertion::task::Task;
use insertion::trial::cell;
use roxmltree::{Document, Node};
use std::collections::BTreeSet;

fn scene(task: &str, robot: &str) -> Scene {
    of(TASKS.iter().find(|file| file.name == task).unwrap(), robot)
}

fn of(task: &Shipped, robot: &str) -> Scene {
    let task = Task::parse(task.text, task.file).unwrap();
    let file = ROBOTS.iter().find(|file| file.name == robot).unwrap();
    let robot = Robot::parse(file.text, file.file).unwrap();
    let finger = Finger::new(2.0 * N_PER_MM, 45.0 * N_PER_MM).with_model(&task.finger, 0.0);
    let mounted = robot.mount(task.turn, task.strategy.tilt).unwrap();
    cell::build(&task, &mounted, &finger).scene
}

fn model(scene: &Scene) -> String {
    write(scene, "a model", &MjcfSettings::default()).unwrap()
}

fn all<'a>(document: &'a Document, tag: &'a str) -> Vec<Node<'a, 'a>> {
    document.descendants().filter(|node| node.has_tag_name(tag)).collect()
}

fn named<'a>(document: &'a Document, tag: &'a str, name: &str) -> Node<'a, 'a> {
    let found = all(document, tag).into_iter().find(|node| node.attribute("name") == Some(name));
    found.unwrap_or_else(|| panic!("there is no {tag} `{name}`"))
}

fn numbers(node: Node, attribute: &str) -> Vec<f64> {
    let text = node.attribute(attribute).unwrap_or("");
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

/// Where a body is, by the poses of those that carry it.
fn pose(node: Node) -> Pose {
    let own = match (&numbers(node, "pos")[..], &numbers(node, "quat")[..]) {
        ([x, y, z], []) => Pose::translation(*x, *y, *z),
        ([x, y, z], [w, i, j, k]) => Pose::from_parts(
            nalgebra::Translation3::new(*x, *y, *z),
            nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(*w, *i, *j, *k)),
        ),
        other => panic!("{other:?}"),
    };
    node.parent().filter(|up| up.has_tag_name("body")).map_or(own, |up| pose(up) * own)
}

#[test]
fn every_body_stands_where_the_scene_has_it() {
    for task in TASKS {
        for robot in ["servo", "rigid"] {
            let scene = scene(task.name, robot);
            let text = model(&scene);
            let document = Document::parse(&text).unwrap();
            assert_eq!(all(&document, "body").len(), scene.bodies.len());
            for body in &scene.bodies {
                let off = pose(named(&document, "body", &body.name)).inv_mul(&body.pose);
                assert!(off.translation.vector.norm() < 1e-12, "{}", body.name);
                assert!(off.rotation.angle() < 1e-12, "{}", body.name);
            }
        }
    }
}

#[test]
fn every_geom_joint_and_pair_is_there_under_a_name_of_its_own() {
    for task in TASKS {
        let scene = scene(task.name, "servo");
        let text = model(&scene);
        let document = Document::parse(&text).unwrap();
        let geoms: usize = scene.bodies.iter().map(|body| body.geoms.len()).sum();
        // Those in <default> have no name.
        let names = |tag| -> Vec<_> {
            all(&document, tag).iter().filter_map(|node| node.attribute("name")).collect()
        };
        assert_eq!(names("geom").len(), geoms);
        for tag in ["body", "geom", "joint", "mesh", "position"] {
            let unique: BTreeSet<_> = names(tag).into_iter().collect();
            assert_eq!(unique.len(), names(tag).len(), "{tag}");
        }
        // Six of the command, six of the servo, a slide and six springs for each hand.
        assert_eq!(names("joint").len(), 6 + 6 + 2 * (1 + 6));
        assert_eq!(all(&document, "freejoint").len(), 1);
        // The command's and the jaws'.
        assert_eq!(names("position").len(), 6 + 2);
        let count = |id: &BodyId| scene.bodies[id.0].geoms.len();
        let pairs: usize =
            scene.contacts.iter().map(|pair| count(&pair.first) * count(&pair.second)).sum();
        assert_eq!(all(&document, "pair").len(), pairs);
        let geoms: BTreeSet<_> = names("geom").into_iter().collect();
        for pair in all(&document, "pair") {
            for end in ["geom1", "geom2"] {
                assert!(geoms.contains(pair.attribute(end).unwrap()));
            }
        }
    }
}

#[test]
fn lengths_are_metres_and_springs_are_the_finger_s() {
    let text = model(&scene("usb", "servo"));
    let document = Document::parse(&text).unwrap();
    let shell = named(&document, "geom", "plug: metal shell");
    let close = |found: Vec<f64>, expected: &[f64]| {
        assert_eq!(found.len(), expected.len());
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    };
    close(numbers(shell, "size"), &[2.24e-3, 6e-3, 6.285e-3]);
    let taper = named(&document, "mesh", "hull of plug: taper");
    assert_eq!(numbers(taper, "vertex").len(), 3 * 8);
    assert!(numbers(taper, "vertex").iter().all(|at| at.abs() < 8e-3));
    let spring = |axis| named(&document, "joint", &format!("springs +y {axis}"));
    for (axis, stiffness) in [("x", 1e5), ("y", 2e3), ("z", 45e3), ("rx", 2.0), ("rz", 10.0)] {
        assert_eq!(numbers(spring(axis), "stiffness"), [stiffness], "{axis}");
    }
    close(numbers(spring("rx"), "pos"), &[0.0, 0.0, -21e-3]);
    let jaw = named(&document, "position", "slide +y y");
    assert_eq!(numbers(jaw, "kp"), [1000.0]);
    assert_eq!(numbers(jaw, "forcerange"), [-5.0, 5.0]);
    let plug = named(&document, "body", "plug");
    let inertial = plug.children().find(|node| node.has_tag_name("inertial")).unwrap();
    assert_eq!(numbers(inertial, "mass"), [5e-3]);
}

/// Contact stiffness does not depend on the masses: `R = A (1 - d)/d`,
/// stiffness `solref/(d R)`, with MuJoCo's inverse masses `A` of the pair.
#[test]
fn contacts_have_the_stiffness_and_friction_of_the_pair() {
    let settings = MjcfSettings::default();
    let text = model(&scene("ket8", "servo"));
    let document = Document::parse(&text).unwrap();
    let pair = |a: &str, b: &str| {
        let ends = [Some(a), Some(b)];
        let is = |node: &Node| [node.attribute("geom1"), node.attribute("geom2")] == ends;
        all(&document, "pair").into_iter().find(is).unwrap()
    };
    // A key of 21.98 g on the fixed plate, and on a finger of 2 g.
    let (key, finger) = (1.0 / 21.98e-3, 1.0 / 2e-3);
    for (found, weight, friction) in [
        (pair("plug: key", "socket: plate at -y"), key, vec![0.2, 0.2]),
        (pair("finger -y: pad", "plug: key"), key + finger, vec![1.0, 1.0, 0.03]),
    ] {
        let impedance = numbers(found, "solimp")[0];
        let regular = weight * (1.0 - impedance) / impedance;
        let [stiffness, damping] = numbers(found, "solref")[..] else { panic!() };
        let give = [stiffness, damping].map(|by| -by / impedance / regular);
        assert!((give[0] / settings.contact_stiffness - 1.0).abs() < 1e-9, "{give:?}");
        assert!((give[1] / settings.contact_damping - 1.0).abs() < 1e-9, "{give:?}");
        let rough = numbers(found, "friction");
        assert!(rough.iter().zip(&friction).all(|(a, b)| (a - b).abs() < 1e-12), "{rough:?}");
        assert_eq!(numbers(found, "condim"), [if friction.len() == 3 { 4.0 } else { 3.0 }]);
    }
}

#[test]
fn what_mjcf_cannot_say_is_refused_by_name() {
    let arm = supports(&scene("usb", "ur5e")).unwrap_err();
    assert_eq!(
        arm.to_string(),
        "`flange` cannot be written as MJCF, which does not support mass that depends on the \
         direction"
    );
    let mut off = scene("usb", "servo");
    let joint = &mut off.joints[0];
    joint.in_parent = Pose::translation(0.0, 0.0, 1e-6) * joint.in_parent;
    assert_eq!(supports(&off).unwrap_err().feature, "joints with nonzero initial coordinates");
    let mut twice = scene("usb", "servo");
    let again = twice.joints[0].clone();
    twice.joints.push(again);
    assert_eq!(supports(&twice).unwrap_err().feature, "bodies on two joints");
}

#[test]
fn geoms_of_one_name_are_told_apart() {
    let mut scene = scene("ket8", "servo");
    let plug = scene.bodies.iter_mut().find(|body| body.name == "plug").unwrap();
    let key = plug.geoms[0].clone();
    plug.geoms.extend([key.clone(), key]);
    let names = geom_names(&scene);
    let names = names.iter().find(|names| names.contains(&"plug: key".into())).unwrap();
    assert_eq!(names[..], ["plug: key", "plug: key 2", "plug: key 3"]);
}

/// No contact's impedance is at an end of what MuJoCo can represent: there it would be softer than
/// it should be. The latch of the connector as sold hangs on a plug of a few grams.
#[test]
fn every_contact_is_as_stiff_as_it_should_be() {
    for task in TASKS.iter().chain(COMMERCIAL) {
        let text = model(&of(task, "servo"));
        let document = Document::parse(&text).unwrap();
        for pair in all(&document, "pair") {
            let impedance = numbers(pair, "solimp")[0];
            assert!((1e-3..0.999).contains(&impedance), "{}: {pair:?}", task.name);
        }
    }
}

#[test]
fn a_mating_force_is_a_tendon_with_its_forces_by_depth() {
    let usb = TASKS.iter().find(|file| file.name == "usb").unwrap();
    let table = "\n[mating_force]\ndepth_mm = [0, 2, 6]\nforce_n = [0, 12, 8]\n";
    let text = model(&of(&Shipped { text: (usb.text.to_owned() + table).leak(), ..*usb }, "servo"));
    let document = Document::parse(&text).unwrap();
    let tendon = named(&document, "spatial", "mating force");
    let on = |site: Node| named(&document, "site", site.attribute("site").unwrap()).parent();
    let ends = tendon.children().filter(|node| node.has_tag_name("site"));
    let bodies: Vec<_> = ends.filter_map(|site| on(site)?.attribute("name")).collect();
    assert_eq!(bodies, ["socket", "plug"]);
    let data =
        |name: &str| numbers(named(&document, "numeric", &format!("mating force: {name}")), "data");
    assert_eq!(data("depth of the tip"), [0.0, 2e-3, 6e-3]);
    assert_eq!(data("frictionloss"), [0.0, 12.0, 8.0]);
    assert!(!model(&of(usb, "servo")).contains("mating force"));
}
