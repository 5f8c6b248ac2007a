//! Whether the picture shows the scene turned, mirrored, enlarged, or with its channels in another order.
//!
//! ```text
//! S(x) = T(π x)           π: one of the eight symmetries of a square, with one of the six orders of three channels
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | S, T | the picture and the correct one | arguments |
//! | π | symmetry and order of channels | [`Placement`] |
//! | – | side of blocks of equal pixels | [`magnified`] |

use super::picture::{Layer, Pictures};
use serde::Serialize;

/// How a picture is turned, and in what order its channels are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Placement {
    /// True if rows and columns are exchanged; this comes first.
    pub transposed: bool,
    /// True if left and right are exchanged.
    pub mirrored: bool,
    /// True if the rows are upside down.
    pub upside_down: bool,
    /// The channel of the scene that each channel of the picture shows.
    pub channels: [usize; 3],
}

/// Side of the blocks, in pixels, whose means are compared.
const BLOCK: usize = 4;
/// Another placement must leave at most this fraction of the variance unexplained.
const BETTER: f64 = 0.4;
/// Least correlation of a placement.
const LEAST: f64 = 0.8;

const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [2, 1, 0], [1, 0, 2], [0, 2, 1], [1, 2, 0], [2, 0, 1]];

impl Placement {
    /// The right one.
    pub const RIGHT: Self = Self { transposed: false, mirrored: false, upside_down: false, channels: ORDERS[0] };

    fn all(square: bool) -> Vec<Self> {
        let turns = (0..if square { 8 } else { 4 }).map(|i| (i & 4 > 0, i & 1 > 0, i & 2 > 0));
        turns
            .flat_map(|(transposed, mirrored, upside_down)| {
                ORDERS.map(|channels| Self { transposed, mirrored, upside_down, channels })
            })
            .collect()
    }

    /// The pixel of the picture that shows pixel `p` of the scene.
    fn source(self, p: usize, [w, h]: [usize; 2]) -> usize {
        let (mut x, mut y) = (p % w, p / w);
        if self.mirrored {
            x = w - 1 - x;
        }
        if self.upside_down {
            y = h - 1 - y;
        }
        if self.transposed { x * w + y } else { y * w + x }
    }

    /// Turns a picture back.
    pub fn undo<T: Copy>(self, pixels: &[[T; 3]], size: [usize; 2]) -> Vec<[T; 3]> {
        let pixel = |p: usize| {
            let v = pixels[self.source(p, size)];
            let mut back = v;
            (0..3).for_each(|c| back[self.channels[c]] = v[c]);
            back
        };
        (0..pixels.len()).map(pixel).collect()
    }

    /// Turns all layers back.
    pub fn undo_all(self, pictures: &Pictures) -> Pictures {
        let size = pictures.size;
        let layer = |l: &Layer| Layer {
            slot: l.slot,
            mean: self.undo(&l.mean, size),
            std_error: l.std_error.as_ref().map(|s| self.undo(s, size)),
        };
        let step = if pictures.step.is_empty() { vec![] } else { self.undo(&pictures.step, size) };
        Pictures { layers: pictures.layers.iter().map(layer).collect(), step, ..pictures.clone() }
    }
}

impl std::fmt::Display for Placement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let turn = match (self.transposed, self.mirrored, self.upside_down) {
            (false, false, false) => "",
            (false, true, false) => "mirrored left to right",
            (false, false, true) => "upside down",
            (false, true, true) => "turned by 180°",
            (true, false, false) => "with rows and columns exchanged",
            (true, true, true) => "with rows and columns exchanged, and turned by 180°",
            (true, ..) => "turned by 90°",
        };
        let turn = if turn.is_empty() { String::new() } else { format!("the picture is {turn}") };
        let order: String = self.channels.iter().map(|c| ["R", "G", "B"][*c]).collect();
        let channels = match order.as_str() {
            "RGB" => String::new(),
            "BGR" => "its red and blue channels are exchanged".to_owned(),
            "GRB" => "its red and green channels are exchanged".to_owned(),
            "RBG" => "its green and blue channels are exchanged".to_owned(),
            order => format!("its channels are in the order {order}"),
        };
        let both = if turn.is_empty() || channels.is_empty() { "" } else { ", and " };
        write!(f, "{turn}{both}{channels}")
    }
}

/// The placement that explains a picture much better than the right one does, with the correlation of both.
pub fn placement(suspect: &Pictures, reference: &Pictures) -> Option<(Placement, [f64; 2])> {
    let [a, b] = suspect.image_in_common(reference)?;
    let size = suspect.size;
    let right = blocks(&b, size);
    let floor = 1e-3 * right.iter().flatten().sum::<f64>() / (3 * right.len()) as f64;
    let logs = |blocks: Vec<[f64; 3]>| {
        blocks.into_iter().flat_map(|v| v.map(|x| (x.max(0.0) + floor).ln())).collect::<Vec<f64>>()
    };
    let right = logs(right);
    let likeness = |p: Placement| correlation(&logs(blocks(&p.undo(&a, size), size)), &right);
    let here = likeness(Placement::RIGHT);
    let all = Placement::all(size[0] == size[1]).into_iter().map(|p| (p, likeness(p)));
    let (best, there) = all.filter(|l| l.1.is_finite()).max_by(|a, b| a.1.total_cmp(&b.1))?;
    (best != Placement::RIGHT && there > LEAST && 1.0 - there < BETTER * (1.0 - here)).then_some((best, [here, there]))
}

/// Means over blocks.
fn blocks(pixels: &[[f32; 3]], [w, h]: [usize; 2]) -> Vec<[f64; 3]> {
    let (columns, rows) = (w.div_ceil(BLOCK), h.div_ceil(BLOCK));
    let mut sums = vec![([0.0; 3], 0.0); columns * rows];
    for (p, v) in pixels.iter().enumerate().filter(|(_, v)| v.iter().all(|x| x.is_finite())) {
        let (sum, n) = &mut sums[p / w / BLOCK * columns + p % w / BLOCK];
        (0..3).for_each(|c| sum[c] += f64::from(v[c]));
        *n += 1.0;
    }
    sums.into_iter().map(|(sum, n): ([f64; 3], f64)| sum.map(|s| s / n.max(1.0))).collect()
}

fn correlation(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sum = |f: &dyn Fn(f64, f64) -> f64| x.iter().zip(y).map(|(a, b)| f(a - mx, b - my)).sum::<f64>();
    sum(&|a, b| a * b) / (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt()
}

/// The side of the blocks of equal pixels, if the picture is made of such blocks: 2, 3 or 4.
pub fn magnified(stored: &Pictures) -> Option<usize> {
    let layer = stored.layers.last()?;
    let [w, h] = stored.size;
    let same = |n: usize, x: usize, y: usize| {
        let first = layer.mean[y * n * w + x * n];
        (0..n * n).all(|i| layer.mean[(y * n + i / n) * w + x * n + i % n] == first)
    };
    let varies = layer.mean.windows(2).filter(|p| p[0] != p[1]).count() * 8 > layer.mean.len();
    let made_of = |n: &usize| {
        let blocks = (w / n) * (h / n);
        let equal = (0..blocks).filter(|i| same(*n, i % (w / n), i / (w / n))).count();
        10 * equal > 9 * blocks
    };
    [4, 3, 2].into_iter().filter(|n| varies && w > 4 * n && h > 4 * n).find(made_of)
}
