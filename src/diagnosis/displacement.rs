//! Whether the picture is shifted, and whether its edges are blurred or sharpened.
//!
//! ```text
//! S(x) ≈ T(x + δ) ≈ T(x) + δ·∇T(x)          δ by least squares, with a factor for every block of the picture
//! s = Σ ∇S·∇T/Σ |∇T|²                       over edges
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | S, T | the picture and the correct one | arguments |
//! | −δ | displacement of the picture in pixels, x to the right, y down | [`Shift::by`] |
//! | s | contrast of edges: 1 for a box filter, about 0.7 for wide pixel filters | [`sharpness`] |
//!
//! The errors come from the scatter between blocks (jackknife). A picture without antialiasing has edges that are off by up to half
//! a pixel, but in different directions; only a displacement that all blocks share is reported.

use super::picture::{Layer, Pictures};
use super::regions::holds;
use serde::Serialize;

/// A displacement of the whole picture.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Shift {
    /// Pixels to the right, and down.
    pub by: [f64; 2],
    /// Half widths of their 95 % intervals.
    pub half_width: [f64; 2],
}

impl Shift {
    /// The pictures and their errors with this displacement, by bilinear interpolation.
    pub fn applied(&self, pictures: &Pictures) -> Pictures {
        let [w, h] = pictures.size;
        let moved = |pixels: &Vec<[f32; 3]>| -> Vec<[f32; 3]> {
            let fields: [Field; 3] = std::array::from_fn(|c| {
                let right = pixels.iter().map(|v| f64::from(v[c])).collect();
                Field { size: [w, h], seen: vec![], right, mask: &[] }
            });
            let at = |p: usize, f: &Field| f.at((p % w) as f64 - self.by[0], (p / w) as f64 - self.by[1]) as f32;
            (0..w * h).map(|p| std::array::from_fn(|c| at(p, &fields[c]))).collect()
        };
        let layer =
            |l: &Layer| Layer { slot: l.slot, mean: moved(&l.mean), std_error: l.std_error.as_ref().map(moved) };
        Pictures { layers: pictures.layers.iter().map(layer).collect(), ..pictures.clone() }
    }

    /// The mask with the border that a displaced picture does not know.
    pub fn border(&self, mask: &[bool], [w, h]: [usize; 2]) -> Vec<bool> {
        let [x, y] = self.by.map(|d| d.abs().ceil() as usize);
        let outside = |p: usize| p % w < x || p % w + x >= w || p / w < y || p / w + y >= h;
        (0..w * h).map(|p| outside(p) || holds(mask, p)).collect()
    }
}

/// Blocks per side for the displacement.
const SIDE: usize = 4;
/// Largest displacement in pixels that is sought.
const FARTHEST: isize = 3;
/// Displacements below this many pixels are not reported.
const SMALLEST: f64 = 0.12;
/// A displacement must be this many standard errors.
const CERTAIN: f64 = 6.0;
/// The same for each channel, which has more noise.
const CHANNEL: f64 = 0.7;
/// Largest half width of the interval of a displacement.
const VAGUE: f64 = 0.25;
/// At edges, the squared difference must fall to this fraction. Otherwise the picture is distorted, and not only shifted.
const NEARER: f64 = 0.4;

/// The displacement of a picture, if there is a significant one. Pixels of the mask are left out.
pub fn shift(suspect: &Pictures, reference: &Pictures, mask: &[bool]) -> Option<Shift> {
    let [a, b] = suspect.image_in_common(reference)?;
    let field = field(&grey(&a), &grey(&b), suspect.size, mask)?;
    let [w, h] = suspect.size;
    if w.min(h) < 4 * SIDE {
        return None;
    }
    let steps = || -FARTHEST..=FARTHEST;
    let whole = steps().flat_map(|y| steps().map(move |x| [x as f64, y as f64]));
    let mut delta = whole.map(|d| (d, field.distance(d, &[]))).min_by(|a, b| a.1.total_cmp(&b.1))?.0;
    let mut error = [f64::INFINITY; 2];
    for _ in 0..4 {
        let step;
        (step, error) = field.step(delta)?;
        (0..2).for_each(|i| delta[i] += step[i].clamp(-1.0, 1.0));
    }
    let sharp = error.iter().all(|e| 2.13 * e < VAGUE);
    let far = sharp && (0..2).any(|i| delta[i].abs() > SMALLEST && delta[i].abs() > CERTAIN * error[i]);
    let edges = field.edges();
    // a displacement of one channel is no displacement of the picture
    let agrees = |c: usize| {
        let channel = |v: &[[f32; 3]]| v.iter().map(|v| f64::from(v[c])).collect::<Vec<f64>>();
        let own = self::field(&channel(&a), &channel(&b), suspect.size, mask);
        own.is_none_or(|f| f.distance(delta, &edges) < CHANNEL * f.distance([0.0; 2], &edges))
    };
    let nearer = field.distance(delta, &edges) < NEARER * field.distance([0.0; 2], &edges);
    let shift = Shift { by: delta.map(|d| -d), half_width: error.map(|e| 2.13 * e) };
    (far && nearer && (0..3).all(agrees) && delta.iter().all(|d| d.abs() < FARTHEST as f64 - 0.25)).then_some(shift)
}

/// Smallest mean change over two pixels, relative to the brightness, at what counts as edges.
const STEEP: f64 = 0.2;

/// The contrast of edges, with its standard error. Pixels of the mask are left out. None if there are too few edges.
pub fn sharpness(suspect: &Pictures, reference: &Pictures, mask: &[bool]) -> Option<[f64; 2]> {
    let [a, b] = suspect.image_in_common(reference)?;
    let field = field(&grey(&a), &grey(&b), suspect.size, mask)?;
    let (edges, [w, _], floor) = (field.edges(), suspect.size, field.floor());
    let seen = Field { right: field.seen.clone(), ..field.clone() };
    let mut blocks = vec![[0.0; 2]; SIDE * SIDE];
    let mut steep = 0.0;
    for (x, y, block) in field.pixels().filter(|(x, y, _)| edges[y * w + x]) {
        let slope = |f: &Field| {
            let (x, y) = (x as f64, y as f64);
            [f.at(x + 1.0, y) - f.at(x - 1.0, y), f.at(x, y + 1.0) - f.at(x, y - 1.0)]
        };
        let (s, t) = (slope(&seen), slope(&field));
        let weight = (field.at(x as f64, y as f64) + floor).powi(-2);
        blocks[block][0] += weight * (s[0] * t[0] + s[1] * t[1]);
        let square = weight * (t[0] * t[0] + t[1] * t[1]);
        blocks[block][1] += square;
        steep += square.sqrt();
    }
    let n = edges.iter().filter(|e| **e).count() as f64;
    // without edges, the steepest places of the correct picture are noise
    if steep < STEEP * n {
        return None;
    }
    blocks.retain(|b| b[1] > 0.0);
    let total = |leave: Option<usize>| {
        let sum =
            |i: usize| blocks.iter().enumerate().filter(|(j, _)| Some(*j) != leave).map(|(_, b)| b[i]).sum::<f64>();
        sum(0) / sum(1)
    };
    let n = blocks.len() as f64;
    if blocks.len() < SIDE {
        return None;
    }
    let left: Vec<f64> = (0..blocks.len()).map(|i| total(Some(i))).collect();
    let mean = left.iter().sum::<f64>() / n;
    let error = ((n - 1.0) / n * left.iter().map(|s| (s - mean).powi(2)).sum::<f64>()).sqrt();
    Some([total(None), error])
}

fn grey(v: &[[f32; 3]]) -> Vec<f64> {
    v.iter().map(|v| v.iter().map(|x| f64::from(*x)).sum::<f64>() / 3.0).collect()
}

/// The picture with the brightness of the correct one. The median of their ratio is not moved by lamps.
fn field<'a>(seen: &[f64], right: &[f64], size: [usize; 2], mask: &'a [bool]) -> Option<Field<'a>> {
    let mut ratios: Vec<f64> =
        seen.iter().zip(right).map(|(s, t)| s / t).filter(|r| r.is_finite() && *r > 0.0).collect();
    ratios.sort_by(f64::total_cmp);
    let usual = *ratios.get(ratios.len() / 2)?;
    Some(Field { size, seen: seen.iter().map(|s| s / usual).collect(), right: right.to_vec(), mask })
}

#[derive(Clone)]
struct Field<'a> {
    size: [usize; 2],
    seen: Vec<f64>,
    right: Vec<f64>,
    mask: &'a [bool],
}

impl Field<'_> {
    /// The correct picture at a place between pixels, by bilinear interpolation.
    fn at(&self, x: f64, y: f64) -> f64 {
        let [w, h] = self.size;
        let (x, y) = (x.clamp(0.0, (w - 1) as f64), y.clamp(0.0, (h - 1) as f64));
        let (i, j) = ((x as usize).min(w - 2), (y as usize).min(h - 2));
        let (u, v) = (x - i as f64, y - j as f64);
        let value = |i: usize, j: usize| self.right[j * w + i];
        (1.0 - v) * ((1.0 - u) * value(i, j) + u * value(i + 1, j))
            + v * ((1.0 - u) * value(i, j + 1) + u * value(i + 1, j + 1))
    }

    /// The pixels whose surroundings are known, by block.
    fn pixels(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let [w, h] = self.size;
        let edge = FARTHEST as usize;
        (edge..h - edge)
            .flat_map(move |y| (edge..w - edge).map(move |x| (x, y, y * SIDE / h * SIDE + x * SIDE / w)))
            .filter(move |(x, y, _)| {
                let p = y * w + x;
                !holds(self.mask, p) && self.seen[p].is_finite()
            })
    }

    fn floor(&self) -> f64 {
        0.3 * self.right.iter().sum::<f64>() / self.right.len() as f64
    }

    /// True for the tenth of the pixels where the correct picture changes most, relative to its brightness.
    fn edges(&self) -> Vec<bool> {
        let floor = self.floor();
        let slope = |(x, y, _): (usize, usize, usize)| {
            let (x, y) = (x as f64, y as f64);
            let d = [self.at(x + 1.0, y) - self.at(x - 1.0, y), self.at(x, y + 1.0) - self.at(x, y - 1.0)];
            d[0].hypot(d[1]) / (self.at(x, y) + floor)
        };
        let all: Vec<((usize, usize, usize), f64)> = self.pixels().map(|p| (p, slope(p))).collect();
        let mut slopes: Vec<f64> = all.iter().map(|a| a.1).collect();
        slopes.sort_by(f64::total_cmp);
        let least = slopes.get(slopes.len() * 9 / 10).copied().unwrap_or(0.0);
        let mut edges = vec![false; self.right.len()];
        all.iter().filter(|a| a.1 >= least).for_each(|((x, y, _), _)| edges[y * self.size[0] + x] = true);
        edges
    }

    /// Mean squared difference to the shifted correct picture, relative to its brightness; over some pixels, or over all.
    fn distance(&self, [dx, dy]: [f64; 2], only: &[bool]) -> f64 {
        let floor = self.floor();
        let (mut sum, mut n) = (0.0, 0.0);
        for (x, y, _) in self.pixels().filter(|(x, y, _)| only.get(y * self.size[0] + x).copied().unwrap_or(true)) {
            let right = self.at(x as f64 + dx, y as f64 + dy);
            sum += ((self.seen[y * self.size[0] + x] - right) / (right + floor)).powi(2).min(1.0);
            n += 1.0;
        }
        sum / n
    }

    /// One step of Gauss and Newton, with its standard error from the scatter between blocks.
    fn step(&self, [dx, dy]: [f64; 2]) -> Option<([f64; 2], [f64; 2])> {
        let floor = self.floor();
        // normal equations of each block for a factor and the two displacements
        let mut blocks = vec![([[0.0; 3]; 3], [0.0; 3]); SIDE * SIDE];
        for (x, y, block) in self.pixels() {
            let (fx, fy) = (x as f64 + dx, y as f64 + dy);
            let right = self.at(fx, fy);
            let gx = 0.5 * (self.at(fx + 1.0, fy) - self.at(fx - 1.0, fy));
            let gy = 0.5 * (self.at(fx, fy + 1.0) - self.at(fx, fy - 1.0));
            let weight = (right + floor).powi(-2);
            let off = self.seen[y * self.size[0] + x] - right;
            // a difference that is larger than the picture itself belongs to an edge of a lamp or to a firefly
            if off.abs() > right + floor {
                continue;
            }
            let row = [right, gx, gy];
            let (a, b) = &mut blocks[block];
            for i in 0..3 {
                (0..3).for_each(|j| a[i][j] += weight * row[i] * row[j]);
                b[i] += weight * row[i] * off;
            }
        }
        // eliminate the factor of each block
        let reduced: Vec<([[f64; 2]; 2], [f64; 2])> = blocks
            .iter()
            .filter(|(a, _)| a[0][0] > 0.0)
            .map(|(a, b)| {
                let m = std::array::from_fn(|i| {
                    std::array::from_fn(|j| a[i + 1][j + 1] - a[i + 1][0] * a[0][j + 1] / a[0][0])
                });
                (m, std::array::from_fn(|i| b[i + 1] - a[i + 1][0] * b[0] / a[0][0]))
            })
            .collect();
        let solve = |leave: Option<usize>| {
            let (mut m, mut v) = ([[0.0; 2]; 2], [0.0; 2]);
            for (_, (a, b)) in reduced.iter().enumerate().filter(|(i, _)| Some(*i) != leave) {
                for i in 0..2 {
                    (0..2).for_each(|j| m[i][j] += a[i][j]);
                    v[i] += b[i];
                }
            }
            let det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
            (det > 0.0).then(|| [(v[0] * m[1][1] - v[1] * m[0][1]) / det, (v[1] * m[0][0] - v[0] * m[1][0]) / det])
        };
        let all = solve(None)?;
        let n = reduced.len() as f64;
        let left: Vec<[f64; 2]> = (0..reduced.len()).filter_map(|i| solve(Some(i))).collect();
        let error = std::array::from_fn(|i| {
            let mean = left.iter().map(|d| d[i]).sum::<f64>() / n;
            ((n - 1.0) / n * left.iter().map(|d| (d[i] - mean).powi(2)).sum::<f64>()).sqrt()
        });
        Some((all, error))
    }
}
