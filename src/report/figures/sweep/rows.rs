//! Cost and noise for each value of a setting: every number in tables, and as CSV.

use crate::engine::by_rays::Sampled;
use crate::report::text::{
    csv::Csv,
    number::{average, error, significant},
    table::{Side, aligned},
};
use crate::terms::scatter::Scatter;
use crate::terms::variance::Variance;
use crate::terms::{Estimate, Functional};

/// Cost and noise with one value of the setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The value as it was typed.
    pub value: String,
    /// Samples per pixel.
    pub spp: u32,
    /// Paths started.
    pub paths: u64,
    /// Means and errors of the image.
    pub image: Functional,
    /// Rays by slot: k = 0..=K, tail.
    pub rays: Vec<u64>,
    /// Variance of one sample by slot.
    pub variance: Vec<Variance>,
    /// Variance of one sample of the sum of all slots.
    pub total: Variance,
    /// Variance of one sample without each replicate: a list for each slot, then for the sum. Empty without replicates.
    pub without: Vec<Vec<f64>>,
    /// Finite, infinite or unknown: the variance of the tail and of the sum is finite under the roulette that was used.
    pub known: crate::terms::Variance,
    /// Wall-clock seconds.
    pub seconds: f64,
}

impl Row {
    /// The numbers of a finished run.
    pub fn new(value: &str, sampled: &Sampled) -> Self {
        let unknown = Variance { value: f64::NAN, std_error: f64::NAN, ..Variance::default() };
        // variances of the mean of n samples, times n
        let (slots, total) = match sampled.snapshots.last() {
            Some(s) => {
                let n = f64::from(s.spp);
                let one = |v: &Variance| Variance {
                    value: n * v.value,
                    channels: n * v.channels,
                    std_error: n * v.std_error,
                };
                (s.slots.iter().map(one).collect(), one(&s.total))
            }
            None => (vec![unknown; sampled.rays.len()], unknown),
        };
        let without = sampled.snapshots.last().map_or(vec![], |s| {
            let n = f64::from(s.spp);
            let leave = |of: &Scatter| (0..of.replicates()).map(|i| n * of.variance_without(i)).collect();
            s.scatter.iter().map(leave).collect()
        });
        Self {
            value: value.into(),
            spp: sampled.spp,
            paths: sampled.series.cost.paths,
            image: sampled.series.image().clone(),
            rays: sampled.rays.clone(),
            variance: slots,
            total,
            without,
            known: sampled.series.variance,
            seconds: sampled.series.cost.seconds,
        }
    }

    /// Rays of all slots per path.
    pub fn rays_per_path(&self) -> f64 {
        self.rays.iter().sum::<u64>() as f64 / self.paths as f64
    }

    /// 1/(V · rays) and 1/(V · seconds), both per path.
    pub fn efficiency(&self, variance: f64) -> [f64; 2] {
        [self.rays_per_path(), self.seconds / self.paths as f64].map(|cost| 1.0 / (variance * cost))
    }

    /// Name, estimate, variance and rays of every term, of the tail if there is one, and of the whole.
    fn parts(&self) -> Vec<(String, Estimate, Variance, u64)> {
        let Functional { terms, tail, total, .. } = &self.image;
        let term = |(k, e): (usize, &Estimate)| (k.to_string(), *e, self.variance[k], self.rays[k]);
        let mut parts: Vec<_> = terms.iter().enumerate().map(term).collect();
        let last = terms.len();
        if !tail.is_none() {
            parts.push(("tail".into(), *tail, self.variance[last], self.rays[last]));
        }
        parts.push(("all".into(), *total, self.total, self.rays.iter().sum()));
        parts
    }
}

/// A setting and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The setting: `branching`, `technique`, ….
    pub over: String,
    /// One per value.
    pub rows: Vec<Row>,
}

/// Every number in two tables: the whole image for each value, and every term for each value.
pub fn table(sweep: &Sweep) -> String {
    let number = |x: f64| if x.is_infinite() { "∞".into() } else { known_to(x, 3) };
    let cost = |r: &Row, v: f64| r.efficiency(v).map(number);
    let header = [&sweep.over, "spp", "mean", "± 95 %", "rays/path", "µs/path", "variance V", "1/(V rays)", "1/(V s)"];
    let mut rows = vec![header.map(String::from).to_vec()];
    rows.extend(sweep.rows.iter().map(|r| {
        let mean = average(&r.image.total).0;
        let [per_ray, per_second] = cost(r, r.total.value);
        let time = 1e6 * r.seconds / r.paths as f64;
        let numbers = [significant(mean, 4), error(&r.image.total), number(r.rays_per_path()), number(time)];
        let cut = if r.image.tail.is_none() { " (cut at K)" } else { "" };
        let head = [format!("{}{cut}", r.value), r.spp.to_string()];
        head.into_iter().chain(numbers).chain([number(r.total.value), per_ray, per_second]).collect()
    }));
    let whole = aligned(&rows, &[[Side::Left].as_slice(), &[Side::Right; 8]].concat());

    let header = [&sweep.over, "k", "mean", "± 95 %", "rays/path", "variance V", "1/(V rays)", "1/(V s)"];
    let mut rows = vec![header.map(String::from).to_vec()];
    for r in &sweep.rows {
        let parts = r.parts();
        rows.extend(parts[..parts.len() - 1].iter().map(|(k, e, v, rays)| {
            let mean = average(e).0;
            let [per_ray, per_second] = cost(r, v.value);
            let numbers = [significant(mean, 4), error(e), number(*rays as f64 / r.paths as f64), number(v.value)];
            [r.value.clone(), k.clone()].into_iter().chain(numbers).chain([per_ray, per_second]).collect()
        }));
    }
    let terms = aligned(&rows, &[[Side::Left].as_slice(), &[Side::Right; 7]].concat());
    format!("the whole image\n{whole}\nterm by term, each charged with the whole path\n{terms}")
}

fn known_to(x: f64, digits: usize) -> String {
    if x.is_nan() { "–".into() } else { significant(x, digits) }
}

/// Every number as CSV: one line per value and k (`0`, `1`, …, `tail`, `all`). Numbers that are not known are left empty.
pub fn csv(sweep: &Sweep) -> String {
    let mut csv = Csv::new(
        "over,value,k,spp,paths,mean,std_error,mean_r,mean_g,mean_b,std_error_r,std_error_g,std_error_b,replicates,rays,\
         rays_per_path,variance,variance_std_error,seconds,efficiency_per_ray,efficiency_per_second",
    );
    for r in &sweep.rows {
        for (k, e, v, rays) in r.parts() {
            let [per_ray, per_second] = r.efficiency(v.value);
            csv.put(&sweep.over).put(&r.value).put(k).put(r.spp).put(r.paths);
            csv.numbers([e.mean.element_sum() / 3.0, e.std_error.element_sum() / 3.0]);
            csv.numbers(e.mean.to_array()).numbers(e.std_error.to_array());
            csv.put(e.replicates).put(rays).numbers([rays as f64 / r.paths as f64]);
            csv.numbers([v.value, v.std_error, r.seconds, per_ray, per_second]).end();
        }
    }
    csv.text()
}
