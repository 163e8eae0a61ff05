//! Search for the contact modes in which the peg is in equilibrium.

use super::equilibrium::Problem;
use super::{Feature, V3};

/// Motion of a contact in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Sliding along the tangent (the normal turned by a quarter turn).
    Forward,
    /// Sliding against the tangent.
    Backward,
    /// Sticking.
    Stick,
}

/// Closed contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Features in contact.
    pub feature: Feature,
    /// Motion in the last step.
    pub mode: Mode,
    /// Normal force on the peg, N.
    pub normal: f64,
    /// Force along the tangent on the peg, N.
    pub tangential: f64,
}

/// Pose of the peg and its contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Coordinates of the compliance centre.
    pub pose: V3,
    /// Closed contacts.
    pub contacts: Vec<Contact>,
}

impl State {
    /// Returns whether two contacts stick, so that the peg is held whatever moves the springs.
    pub fn locked(&self) -> bool {
        self.contacts.len() == 2 && self.contacts.iter().all(|contact| contact.mode == Mode::Stick)
    }
}

/// Rounding errors of forces, N, of ways along the outlines, m, and of gaps, m.
const FORCE: f64 = 1e-10;
const WAY: f64 = 1e-12;
const GAP: f64 = 1e-15;

/// Contacts of the old state with their modes, none of a mode or more than two.
type Choice = Vec<(Feature, Mode)>;

impl Problem<'_> {
    /// Returns the state after a step in which the compliance centre moves by at most `bound`, m.
    /// The modes of the old state are tried first, then all: of several equilibria the nearest is
    /// taken, and one that moves rather than one that is locked.
    pub fn step(&self, bound: f64) -> Option<State> {
        let before: Choice = self.old.contacts.iter().map(|c| (c.feature, c.mode)).collect();
        let same = self.state(&before).filter(|state| self.moved(state) <= bound);
        if same.is_some() {
            return same;
        }
        let near = self.near(bound);
        let found = choices(&near).into_iter().filter_map(|choice| self.state(&choice));
        let within = found.filter(|state| self.moved(state) <= bound);
        within.min_by(|a, b| {
            let key = |state: &State| (state.locked(), self.moved(state));
            let ((a, moved_a), (b, moved_b)) = (key(a), key(b));
            a.cmp(&b).then(moved_a.total_cmp(&moved_b))
        })
    }

    /// Returns the features that may touch within a way of the peg, m.
    fn near(&self, way: f64) -> Vec<Feature> {
        let touches = self.geometry.touches(&self.old.pose).into_iter();
        let close = touches.filter(|(_, touch)| touch.gap.abs() <= way && touch.reach >= -way);
        close.map(|(feature, _)| feature).collect()
    }

    /// Returns the way of the tip and the compliance centre in a step, m.
    pub fn moved(&self, state: &State) -> f64 {
        let way = state.pose - self.old.pose;
        let turn = way.z.abs() * self.assembly.support.centre;
        way.x.abs().max(way.y.abs()) + turn
    }

    /// Returns the equilibrium of a choice of modes if it meets all conditions of contact.
    fn state(&self, choice: &[(Feature, Mode)]) -> Option<State> {
        let state = match choice {
            [(first, Mode::Stick), (second, Mode::Stick)] if self.assembly.compliance == 0.0 => {
                self.locked([*first, *second])
            }
            _ => self.solve(choice),
        }?;
        let normals = state.contacts.iter().map(|contact| contact.normal);
        let sunk = self.assembly.compliance * normals.fold(0.0, f64::max);
        let valid = state.contacts.iter().all(|contact| self.holds(contact, &state.pose))
            && self.geometry.separation(&state.pose) >= -sunk - GAP;
        valid.then_some(state)
    }

    /// Returns whether a contact presses, and slides as its friction does or sticks within its cone.
    fn holds(&self, contact: &Contact, pose: &V3) -> bool {
        let touch = self.geometry.touch(contact.feature, pose);
        let slip = self.slip(&touch, pose);
        let moves = match contact.mode {
            Mode::Forward => slip >= -WAY,
            Mode::Backward => slip <= WAY,
            Mode::Stick => {
                contact.tangential.abs() <= self.assembly.friction * contact.normal + FORCE
            }
        };
        moves && contact.normal >= -FORCE && touch.reach >= -WAY
    }
}

/// Returns all modes of at most two of the features.
fn choices(features: &[Feature]) -> Vec<Choice> {
    const MODES: [Mode; 3] = [Mode::Forward, Mode::Backward, Mode::Stick];
    let mut all = vec![Vec::new()];
    for (i, &first) in features.iter().enumerate() {
        all.extend(MODES.map(|mode| vec![(first, mode)]));
        for &second in &features[i + 1..] {
            for one in MODES {
                all.extend(MODES.map(|other| vec![(first, one), (second, other)]));
            }
        }
    }
    all
}
