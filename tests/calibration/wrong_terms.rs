//! Terms that are a little wrong: each is found with the samples that were planned for it.

use super::*;

/// A matrix of little variance: rows that differ by a tenth or two, nothing lost, a third reflected.
fn quiet() -> MatrixWalk {
    let rows = [[0.2, 0.3, 0.25, 0.25], [0.3, 0.2, 0.25, 0.25], [0.25, 0.25, 0.2, 0.3], [0.25, 0.25, 0.3, 0.2]];
    let rho = [0.3, 0.33, 0.28, 0.31].map(Vec3::splat).to_vec();
    let emission = [1.0, 0.9, 1.1, 0.95].map(Vec3::splat).to_vec();
    MatrixWalk::new(rows.concat(), rho, emission)
}

/// Starts at a random row, so that T0 has a variance, too.
struct AnyRow;

impl Sensor<MatrixWalk> for AnyRow {
    fn size(&self) -> [u32; 2] {
        [PIXELS, 1]
    }
    fn start(&self, _: &MatrixWalk, _: u32, rng: &mut Rng) -> Option<u32> {
        Some(((rng.one() * ROWS as f32) as u32).min(ROWS - 1))
    }
}

const PIXELS: u32 = 64;
/// Samples of each pixel that see 1 %, and 0.5 %, of every slot; [`planned`] says why.
pub(super) const FAST: u32 = 1024;
const LONG: u32 = 4096;
/// Chance to miss them: small enough that a single miss would be a surprise at the ledger's level.
const BETA: f64 = 1e-13;

/// n = ((t* + z_β) cv/δ)² for one comparison of the fast suite.
fn planned(cv: f64, delta: f64) -> f64 {
    needed_samples(cv, delta, ledger::share("the_fast_suite_passes").level(), BETA)
}

/// What is tried: every slot is noisy, and roulette begins where hardly any light is left.
fn tried() -> Prefix {
    Prefix(plan(K, Technique::Mis, &Roulette::Constant { from: 2 * K, q: 0.5 }))
}

/// Every slot as `estimator` finds it in the red channel, and its exact value.
fn slots(estimator: &impl TermEstimator<MatrixWalk>, seed: u64, spp: u32) -> Vec<(Measured, f64)> {
    let t = quiet();
    let r = image_replicates(&any(&t, &AnyRow, estimator, spp, Key::new(seed, "every term")));
    let truth = exact(&t);
    (0..K + 2).map(|s| (Measured::of(&r.estimate(s..s + 1), 0), truth[s].x)).collect()
}

pub(super) fn every_term(seed: u64, spp: u32) -> Vec<(Measured, f64)> {
    slots(&tried(), seed, spp)
}

/// An estimator that is right but for one slot, which it multiplies.
struct Wrong {
    slot: usize,
    factor: f32,
}

struct Scaled<'a, S>(&'a Wrong, &'a mut S);

impl<S: TermSink> TermSink for Scaled<'_, S> {
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        let n = pixel.len();
        let mut value = value.clone();
        if slot == self.0.slot {
            value.scale(&vec![self.0.factor; n], n);
        }
        self.1.add(slot, pixel, sample, &value);
    }
}

impl TermEstimator<MatrixWalk> for Wrong {
    fn slots(&self) -> usize {
        K + 2
    }
    fn sample<S: Sensor<MatrixWalk>>(
        &self,
        job: &Job<'_, MatrixWalk, S>,
        paths: &mut Paths<Vec<u32>>,
        sink: &mut impl TermSink,
    ) {
        tried().sample(job, paths, &mut Scaled(self, sink));
    }
}

/// Whether the fast suite's level rejects `factor` times what was measured.
fn rejected((m, truth): (Measured, f64), factor: f64) -> bool {
    let level = ledger::share("the_fast_suite_passes").level();
    two_sided_p((factor * m.mean - truth) / (factor * m.std_error), m.dof) <= level
}

/// Mean coefficient of variation of one sample, slot by slot.
fn cv(runs: &[Vec<(Measured, f64)>], spp: u32, slot: usize) -> f64 {
    let n = f64::from(spp * PIXELS);
    runs.iter().map(|r| r[slot].0.std_error / r[slot].1 * n.sqrt()).sum::<f64>() / runs.len() as f64
}

/// Wrong estimators as they are, one run after another.
#[test]
fn every_term_that_is_one_percent_off_is_found() {
    const RUNS: u64 = 5;
    let mut account = open("every_term_that_is_one_percent_off_is_found");
    let seed = account.seed();
    let right: Vec<_> = (0..RUNS).map(|i| every_term(seed.wrapping_add(i), FAST)).collect();
    for slot in 0..K + 2 {
        let missed = |factor: f32| {
            let wrong = |i: u64| slots(&Wrong { slot, factor }, seed.wrapping_add(i), FAST);
            (0..RUNS).filter(|&i| !rejected(wrong(i)[slot], 1.0)).count() as u64
        };
        let cv = cv(&right, FAST, slot);
        let (low, high) = (missed(0.99), missed(1.01));
        let n = planned(cv, 0.01);
        eprintln!(
            "{}: cv {cv:.3}, planned {n:.0} of {} samples, {} of 10 missed",
            slot_name(slot),
            FAST * PIXELS,
            low + high
        );
        assert!(n < f64::from(FAST * PIXELS));
        assert_rate_at_most(&mut account, &slot_name(slot), low + high, 2 * RUNS, BETA);
        // and what is right is not rejected
        assert!(right.iter().all(|r| !rejected(r[slot], 1.0)));
    }
}

/// Multiplying a slot while it is sampled or afterwards is the same: one render of the right estimator serves for all wrong ones.
#[test]
fn a_wrong_slot_is_a_multiple_of_the_right_one() {
    let right = every_term(1, 256);
    for slot in 0..K + 2 {
        let wrong = slots(&Wrong { slot, factor: 1.005 }, 1, 256);
        for (s, (w, r)) in wrong.iter().zip(&right).enumerate() {
            let factor = if s == slot { 1.005 } else { 1.0 };
            assert!((w.0.mean / r.0.mean - factor).abs() < 1e-6, "{slot} {s}: {w:?} {r:?}");
            assert!((w.0.std_error / r.0.std_error - factor).abs() < 1e-4, "{slot} {s}: {w:?} {r:?}");
        }
    }
}

#[test]
#[ignore = "3000 runs of a quarter of a million paths: minutes"]
fn half_a_percent_on_any_term_is_found() {
    const RUNS: u64 = 3000;
    let mut account = open("half_a_percent_on_any_term_is_found");
    let seed = account.seed();
    let started = Instant::now();
    let runs: Vec<_> = (0..RUNS).into_par_iter().map(|i| every_term(seed.wrapping_add(i), LONG)).collect();
    eprintln!("{RUNS} runs in {:.0} s", started.elapsed().as_secs_f64());
    for slot in 0..K + 2 {
        let missed = [0.995, 1.005].map(|f| runs.iter().filter(|r| !rejected(r[slot], f)).count() as u64);
        let alarms = runs.iter().filter(|r| rejected(r[slot], 1.0)).count();
        let cv = cv(&runs, LONG, slot);
        let n = planned(cv, 0.005);
        // with no miss in n runs the chance of one is below 3/n, with 95 % confidence
        eprintln!(
            "{}: cv {cv:.3}, planned {n:.0} of {} samples; −0.5 %: {} missed, +0.5 %: {} missed, right: {alarms} rejected; power ≥ {:.4}",
            slot_name(slot),
            LONG * PIXELS,
            missed[0],
            missed[1],
            1.0 - 3.0 / RUNS as f64
        );
        assert!(n < f64::from(LONG * PIXELS));
        assert_rate_at_most(&mut account, &slot_name(slot), missed[0] + missed[1], 2 * RUNS, BETA);
        assert_eq!(alarms, 0);
    }
}
