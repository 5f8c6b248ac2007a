//! The worked example of `CONTRIBUTING.md`: an estimator of emission and direct light only, one path at a time. It is
//! compiled and tested, but not registered.
//!
//! ```text
//! X_0 = E(x_0)        X_1 = weight · E(y),  y drawn on the emitters
//! ```

use super::{Job, Paths, TermEstimator, TermSink};
use crate::math::{Columns, Purpose, Rgb, Rng};
use crate::operator::{Sensor, Transport};

/// Estimator of T⁰E and T¹E.
struct Direct;

impl<T: Transport> TermEstimator<T> for Direct {
    fn slots(&self) -> usize {
        2
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let &Job { t, sensor, batch } = job;
        for sample in batch.samples.clone() {
            for pixel in batch.pixels.clone() {
                // the address of a random number: path, vertex, purpose
                let numbers = |purpose| Rng::at(batch.key, pixel, sample, 0, purpose);
                let mut add = |slot, value: Rgb| {
                    let mut column = Columns::new(1);
                    column.set(0, value);
                    sink.add(slot, &[pixel], &[sample], &column);
                };
                let Some(x) = sensor.start(t, pixel, &mut numbers(Purpose::Start)) else { continue };
                add(0, t.emission(&x));
                if let Some(y) = t.connect(&x, &mut numbers(Purpose::Connect)) {
                    add(1, y.weight * t.emission(&y.state));
                }
            }
        }
        sink.rays(0, batch.len());
        sink.rays(1, batch.len());
    }
}

/// On a matrix the terms are known exactly. With one emitting row every connection is exact, so the estimate has no noise
/// and must equal the known terms.
#[test]
fn the_terms_are_those_of_the_matrix() {
    use super::render::{Amount, render};
    use crate::math::Key;
    use crate::operator::{MatrixWalk, matrix_walk::Rows};
    use crate::progress::Progress;
    let rows = vec![0.0, 0.25, 0.5, 0.0];
    let walk = MatrixWalk::new(rows, vec![Rgb::splat(0.5); 2], vec![Rgb::ZERO, Rgb::ONE]);
    let exact = walk.powers(1);
    let film = render(&walk, &Rows(2), &Direct, Amount::new(16, Key::new(0, "direct")), Progress::NONE);
    for (k, term) in exact.iter().enumerate() {
        for (row, exact) in term.iter().enumerate() {
            let (found, _) = film.pixel(row, k..k + 1);
            assert!((found - *exact).abs().max_element() < 1e-6, "row {row}, k = {k}: {found}");
        }
    }
}
