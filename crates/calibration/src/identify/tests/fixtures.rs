//! Synthetic log for tests.

use crate::identify::log::{Log, LogSample};
use ask_tell::normal::StandardNormal;
use ask_tell::stream::stream;
use input::units::{DEG, MM};
use insertion::Tcp;
use nalgebra::Vector3;
use rand::RngExt;

/// Returns a log at 500 Hz of a descent at 20 mm/s onto a face at 45 mm and 0.4 mm into it, a slide of 5 mm and a
/// descent of 13 mm; stiffness 50 N/mm, coefficient of friction 0.2. `noise` is the standard deviation of the noise,
/// `drift` the total drift, both N. The touch is at 0.3 s.
pub fn synthetic(noise: f64, drift: f64) -> Log {
    let mut random = stream(1, 0, "log");
    let mut normal = || -> f64 { random.sample(StandardNormal) };
    let samples = (0..600).map(|i| {
        let time = f64::from(i) * 2e-3;
        let down = (20.0 * time).min(6.4) + (13.0 * (time - 0.6) / 0.5).clamp(0.0, 13.0);
        let aside = (5.0 * (time - 0.35) / 0.1).clamp(0.0, 5.0);
        let position = Vector3::new(0.0, aside - 1.2, 51.0 - down) * MM;
        let press = 50.0 * (down - 6.0).clamp(0.0, 0.4);
        let rub = if aside > 0.0 { -0.2 * press } else { 0.0 };
        let error = Vector3::from_fn(|_, _| noise * normal());
        let sway = Vector3::new(0.3, -0.2, 0.8 + drift * time / 1.2);
        let force = Vector3::new(0.0, rub, press) + error + sway;
        let tcp = Tcp { position, tilt: 10.0 * DEG };
        let target = Some(Tcp { position: position - Vector3::z() * 1e-5, ..tcp });
        LogSample { line: i as usize + 2, time_s: 7.0 + time, tcp, target, force }
    });
    Log::new("a.csv", samples.collect()).expect("samples in order")
}
