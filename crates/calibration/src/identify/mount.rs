//! Detection of a compliant socket mount or grip. The model has neither: during the push the measured TCP descends more
//! per newton than the simulated one, below which only the fingers are compliant.

use super::check::Remark;
use super::curves::Curves;
use super::question::Compared;
use ask_tell::statistics::median;
use input::units::N_PER_MM;

/// Fractions of the peak force between which the compliance is fitted, where the seated plug is only pressed.
const FORCE_SHARES: [f64; 2] = [0.4, 0.9];
/// Smallest peak force for a fit, N.
const MIN_FORCE_N: f64 = 20.0;
/// Smallest number of intervals between points for a fit.
const MIN_INTERVALS: usize = 4;
/// Smallest additional compliance for a remark, m/N (125 N/mm): more than uncertain stiffness of the fingers explains.
const MIN_COMPLIANCE: f64 = 8e-6;
/// Smallest number of attempts for a remark.
const MIN_ATTEMPTS: usize = 3;

/// Returns a remark if the median of the additional compliance over the attempts is too large; `file` is the table of
/// the runs.
pub fn remark(file: &str, compared: &[Compared]) -> Option<Remark> {
    let more = |one: &Compared| {
        let [measured, simulated] =
            [&one.logged.curves, &one.after.0].map(|curves| compliance(curves, one.logged.push));
        Some(measured? - simulated?)
    };
    compliant(file, &compared.iter().filter_map(more).collect::<Vec<_>>())
}

fn compliant(file: &str, compliances: &[f64]) -> Option<Remark> {
    let more = median(compliances.iter().copied())?;
    let text = format!(
        "under the push the tool sinks as if socket or grip stood on a spring of {:.0} N/mm, which the model does \
         not have: plugs that are straightened only by the push jam sooner than predicted; clamp the socket",
        1.0 / more / N_PER_MM
    );
    let remark = Remark { file: file.to_owned(), lines: None, text, serious: false };
    (compliances.len() >= MIN_ATTEMPTS && more > MIN_COMPLIANCE).then_some(remark)
}

/// Returns the compliance, m/N: the descent of the TCP per newton while the force rises in the push, which begins at
/// index `push`; `None` if the force is too small or rises too fast for a fit.
fn compliance(curves: &Curves, push: usize) -> Option<f64> {
    let pushed = curves.force.get(push..)?;
    let most = (0..pushed.len()).max_by(|&a, &b| pushed[a].z.total_cmp(&pushed[b].z))?;
    let largest = pushed[most].z;
    let before = |end: usize, share: f64| {
        pushed[..=end].iter().rposition(|force| force.z <= share * largest)
    };
    let to = before(most, FORCE_SHARES[1])?;
    let from = before(to, FORCE_SHARES[0])?;
    if largest < MIN_FORCE_N || to - from < MIN_INTERVALS {
        return None;
    }
    let count = (to - from + 1) as f64;
    let pair = |i: usize| (pushed[i].z, curves.tcp[push + i].z);
    let (force, place) = (from..=to).map(pair).fold((0.0, 0.0), |(f, z), (a, b)| (f + a, z + b));
    let (force, place) = (force / count, place / count);
    let terms = (from..=to).map(pair).map(|(f, z)| (f - force, z - place));
    let (product, squares) = terms.fold((0.0, 0.0), |(p, s), (f, z)| (p + f * z, s + f * f));
    (squares > 0.0).then(|| -product / squares)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// Returns curves of a push whose force rises by 1 N per point to 60 N, against a spring of a compliance, m/N.
    fn pressed(per_newton: f64) -> Curves {
        let force = |i: i32| f64::from((i - 20).clamp(0, 60));
        let at = |i: i32| Vector3::new(0.0, 0.0, 0.05 - per_newton * force(i));
        Curves {
            tcp: (0..120).map(at).collect(),
            target: None,
            force: (0..120).map(|i| Vector3::z() * force(i)).collect(),
            tilt: 0.0,
        }
    }

    #[test]
    fn the_compliance_is_that_of_the_spring_and_a_soft_socket_is_reported() {
        let [rigid, soft] = [25e-6, 39e-6].map(|per_newton| compliance(&pressed(per_newton), 10));
        assert!((rigid.unwrap() - 25e-6).abs() < 1e-9);
        let more = soft.unwrap() - rigid.unwrap();
        let remark = compliant("runs.csv", &[more, more, 0.8 * more]).unwrap();
        assert!(remark.text.contains("a spring of 71 N/mm") && !remark.serious, "{remark}");
        assert_eq!(compliant("runs.csv", &[more; 2]), None);
        assert_eq!(compliant("runs.csv", &[4e-6, more, 4e-6]), None);
        let mut too_short = pressed(25e-6);
        too_short.force.truncate(36);
        too_short.tcp.truncate(36);
        assert_eq!(compliance(&too_short, 10), None);
    }
}
