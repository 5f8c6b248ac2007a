//! Regions of the image that are compared: the whole image, a grid of sixteen, and regions defined by what the camera sees.
//!
//! | region | pixels |
//! |---|---|
//! | image | all pixels |
//! | region r,c | a quarter of the rows times a quarter of the columns, without edges |
//! | cell | the same with an eighth, for fits |
//! | lamps | pixels within two pixels of one whose centre ray hits an emitter |
//! | mirrors and glass | pixels whose centre ray hits a surface with a delta component |
//! | grazing | pixels whose centre ray hits a surface at cos θ < 0.25 |
//! | beside lamps | pixels within an eighth of the image width of a lamp that are no edges |
//!
//! *Edges* are pixels next to another surface, and pixels within three pixels of a lamp. Their values depend on the pixel filter: two
//! correct renderers with different filters differ there. Every other pixel, and every sum over a lamp and its surroundings, is nearly
//! the same for all filters.

use super::picture::{Pictures, Slot};
use crate::math::Rgb;
use crate::scene::Scene;

/// A set of pixels with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Name of the region.
    pub name: String,
    /// Indices of its pixels, ascending.
    pub pixels: Vec<usize>,
    /// Pixels of the region whose light is mostly emission seen directly, ascending; see [`lit`].
    pub lamps: Vec<usize>,
    /// Emission seen directly in each of its pixels, for the region [`LAMPS`]; see [`lit`].
    pub emission: Vec<[f32; 3]>,
}

impl Region {
    fn new(name: &str, pixels: Vec<usize>) -> Self {
        Self { name: name.into(), pixels, lamps: vec![], emission: vec![] }
    }

    /// True for a region of the grid, and for a cell.
    pub fn in_grid(&self) -> bool {
        self.name.starts_with("region")
    }
}

/// Smallest number of pixels of a region. Smaller regions are not tested, because their noise cannot be estimated well
/// enough.
pub const FEWEST: usize = 30;
/// Regions per side of the image.
pub const SIDE: usize = 4;

/// The whole image, then the sixteen regions of the grid. Regions with too few pixels are left out.
pub fn grid([w, h]: [usize; 2]) -> Vec<Region> {
    let mut regions = vec![Region::new("image", (0..w * h).collect())];
    regions.extend(tiles([w, h], SIDE));
    regions.retain(|r| r.pixels.len() >= FEWEST);
    regions
}

/// Sixty-four regions for fits, without edges. Regions with too few pixels are left out.
pub fn cells(size: [usize; 2], edges: &[bool]) -> Vec<Region> {
    let mut all = vec![Region::new("image", vec![])];
    let side = if size[0] * size[1] < 64 * FEWEST { SIDE } else { 2 * SIDE };
    all.extend(tiles(size, side));
    let mut all = without(all, edges);
    all.remove(0);
    all.retain(|r| r.pixels.len() >= FEWEST / 2);
    all
}

fn tiles([w, h]: [usize; 2], side: usize) -> Vec<Region> {
    let mut tiles: Vec<Region> =
        (0..side * side).map(|i| Region::new(&format!("region {},{}", i / side, i % side), vec![])).collect();
    (0..w * h).for_each(|p| tiles[p / w * side / h * side + p % w * side / w].pixels.push(p));
    tiles
}

/// Removes edges from all regions but the first, which is the whole image. If hardly any pixel would be left, nothing is removed.
pub fn inside(mut regions: Vec<Region>, edges: &[bool]) -> Vec<Region> {
    if edges.is_empty() || regions.is_empty() {
        return regions;
    }
    let image = regions.remove(0);
    let left: Vec<Region> =
        without(std::iter::once(Region { pixels: vec![], ..image.clone() }).chain(regions).collect(), edges);
    std::iter::once(image).chain(left.into_iter().skip(1)).collect()
}

/// Removes the pixels of a mask (empty: no mask). Regions that become too small are left out, except the first.
pub fn without(regions: Vec<Region>, mask: &[bool]) -> Vec<Region> {
    let left = |r: Region| Region { pixels: r.pixels.into_iter().filter(|&p| !holds(mask, p)).collect(), ..r };
    let mut all: Vec<Region> = regions.into_iter().map(left).collect();
    let mut at = 0;
    all.retain(|r| {
        at += 1;
        at == 1 || r.pixels.len() >= FEWEST / 2
    });
    all
}

/// Finds the lamps of each region: pixels of the reference where emission is more than half of the whole. The region [`LAMPS`] gets
/// its emission.
pub fn lit(regions: Vec<Region>, reference: &Pictures) -> Vec<Region> {
    let (Some(emitted), Some(whole)) = (reference.layer(Slot::Term(0)), reference.layer(Slot::Whole)) else {
        return regions;
    };
    let sum = |v: [f32; 3]| v.iter().sum::<f32>();
    let lamp = |p: &usize| sum(emitted.mean[*p]) > 0.5 * sum(whole.mean[*p]);
    let light = |r: &Region| r.pixels.iter().map(|&p| emitted.mean[p]).collect();
    let with = |r: Region| Region {
        lamps: r.pixels.iter().copied().filter(lamp).collect(),
        emission: if r.name == LAMPS { light(&r) } else { vec![] },
        ..r
    };
    regions.into_iter().map(with).collect()
}

/// True if the mask holds pixel `p`; an empty mask holds nothing.
pub fn holds(mask: &[bool], p: usize) -> bool {
    mask.get(p).copied().unwrap_or(false)
}

/// True where one of two masks is; an empty mask holds nothing.
pub fn either(a: &[bool], b: &[bool]) -> Vec<bool> {
    let n = a.len().max(b.len());
    (0..n).map(|p| holds(a, p) || holds(b, p)).collect()
}

/// A mask with all pixels within `reach` of it.
pub fn widened(mask: &[bool], [w, h]: [usize; 2], reach: usize) -> Vec<bool> {
    let near = |p: usize| {
        let (x, y) = (p % w, p / w);
        let columns = x.saturating_sub(reach)..(x + reach + 1).min(w);
        (y.saturating_sub(reach)..(y + reach + 1).min(h)).any(|v| columns.clone().any(|u| mask[v * w + u]))
    };
    (0..mask.len()).map(near).collect()
}

/// What the camera of a scene sees.
pub struct Seen {
    /// Regions by the surfaces in them. Regions with too few pixels are left out.
    pub regions: Vec<Region>,
    /// True for edges; empty if hardly any pixel is none.
    pub edges: Vec<bool>,
}

/// Pixels this near to a lamp are edges: no usual pixel filter is wider.
const FILTER: isize = 3;
/// At least this share of the pixels must be no edges.
const LEAST: f64 = 0.4;

/// Regions and edges by what the camera of a scene sees.
pub fn seen(scene: &Scene) -> Seen {
    let [w, h] = scene.camera.size.map(|s| s as usize);
    let looks: Vec<_> =
        (0..w * h).map(|p| scene.camera.ray(p as u32, [0.5; 2])).map(|(o, d)| (o, scene.look(o, d))).collect();
    let surface = |p: usize| looks[p].1.filter(|v| v.on_surface());
    let lamp = |p: usize| surface(p).is_some_and(|v| scene.emission(v.side) != Rgb::ZERO);
    let near = |p: usize, reach: isize, of: &dyn Fn(usize) -> bool| {
        let (x, y) = ((p % w) as isize, (p / w) as isize);
        let inside = |x: isize, y: isize| x >= 0 && y >= 0 && x < w as isize && y < h as isize;
        let mut around = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (x + dx, y + dy)));
        around.any(|(x, y)| inside(x, y) && of(y as usize * w + x as usize))
    };
    let differs = |p: usize, q: usize| match (surface(p), surface(q)) {
        (Some(a), Some(b)) => {
            let distance = |p: usize, at: glam::Vec3| (at - looks[p].0).length();
            let (da, db) = (distance(p, a.p), distance(q, b.p));
            a.n.dot(b.n) < 0.9 || (da - db).abs() > 0.1 * da.min(db)
        }
        (None, None) => false,
        _ => true,
    };
    let edge = |p: usize| near(p, 1, &|q| differs(p, q)) || near(p, FILTER, &lamp);
    let mut edges: Vec<bool> = (0..w * h).map(edge).collect();
    if (edges.iter().filter(|e| !**e).count() as f64) < LEAST * (w * h) as f64 {
        edges.clear();
    }
    let is_edge = |p: usize| holds(&edges, p);
    let set =
        |name: &str, inside: &dyn Fn(usize) -> bool| Region::new(name, (0..w * h).filter(|&p| inside(p)).collect());
    let beside = (w / 8).max(1) as isize;
    let mut regions = vec![
        set(LAMPS, &|p| near(p, FILTER - 1, &lamp)),
        set(MIRRORS, &|p| surface(p).is_some_and(|v| scene.bsdf(&v).has_delta())),
        set("grazing", &|p| !is_edge(p) && surface(p).is_some_and(|v| v.n.dot(v.omega) < 0.25)),
        set("beside lamps", &|p| !is_edge(p) && !lamp(p) && near(p, beside, &lamp)),
    ];
    regions.retain(|r| r.pixels.len() >= FEWEST && r.pixels.len() < w * h);
    Seen { regions, edges }
}

/// Name of the region of lamps.
pub const LAMPS: &str = "lamps";
/// Name of the region of mirrors and glass.
pub const MIRRORS: &str = "mirrors and glass";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sixteen_regions_are_a_partition() {
        for size in [[64, 64], [37, 50], [8, 90]] {
            let all = grid(size);
            let mut pixels: Vec<usize> = all[1..].iter().flat_map(|r| r.pixels.clone()).collect();
            pixels.sort_unstable();
            if all.len() == 17 {
                assert_eq!(pixels, all[0].pixels);
            }
            assert_eq!(all[0].pixels.len(), size[0] * size[1]);
        }
        assert_eq!(grid([16, 16]).len(), 1); // regions of 16 pixels are too small
    }
}
