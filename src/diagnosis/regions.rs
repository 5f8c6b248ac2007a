//! Regions of the image that are compared: the whole image, a grid of sixteen, and regions defined by what the camera sees.
//!
//! | region | pixels |
//! |---|---|
//! | image | all pixels |
//! | region r,c | a quarter of the rows times a quarter of the columns |
//! | lamps | pixels whose centre ray hits an emitter |
//! | mirrors and glass | pixels whose centre ray hits a surface with a delta component |
//! | grazing | pixels whose centre ray hits a surface at cos θ < 0.25 |
//! | beside lamps | pixels within an eighth of the image width of a lamp that show no lamp themselves |

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
}

/// Smallest number of pixels of a region. Smaller regions are not tested, because their noise cannot be estimated well
/// enough.
pub const FEWEST: usize = 30;
/// Regions per side of the image.
pub const SIDE: usize = 4;

/// The whole image, then the sixteen regions of the grid. Regions with too few pixels are left out.
pub fn grid([w, h]: [usize; 2]) -> Vec<Region> {
    let mut regions = vec![Region { name: "image".into(), pixels: (0..w * h).collect(), lamps: vec![] }];
    for (row, column) in (0..SIDE).flat_map(|r| (0..SIDE).map(move |c| (r, c))) {
        let inside = |p: &usize| p / w * SIDE / h == row && p % w * SIDE / w == column;
        let pixels: Vec<usize> = (0..w * h).filter(inside).collect();
        regions.push(Region { name: format!("region {row},{column}"), pixels, lamps: vec![] });
    }
    regions.retain(|r| r.pixels.len() >= FEWEST);
    regions
}

/// Removes the pixels of a mask (empty: no mask). Regions that become too small are left out, except the first.
pub fn without(regions: Vec<Region>, mask: &[bool]) -> Vec<Region> {
    let left = |r: Region| Region {
        pixels: r.pixels.into_iter().filter(|&p| !mask.get(p).copied().unwrap_or(false)).collect(),
        ..r
    };
    let mut all: Vec<Region> = regions.into_iter().map(left).collect();
    let mut at = 0;
    all.retain(|r| {
        at += 1;
        at == 1 || r.pixels.len() >= FEWEST
    });
    all
}

/// Finds the lamps of each region: pixels of the reference where emission is more than half of the whole.
pub fn lit(regions: Vec<Region>, reference: &Pictures) -> Vec<Region> {
    let (Some(emitted), Some(whole)) = (reference.layer(Slot::Term(0)), reference.layer(Slot::Whole)) else {
        return regions;
    };
    let sum = |v: [f32; 3]| v.iter().sum::<f32>();
    let lamp = |p: &usize| sum(emitted.mean[*p]) > 0.5 * sum(whole.mean[*p]);
    let with = |r: Region| Region { lamps: r.pixels.iter().copied().filter(lamp).collect(), ..r };
    regions.into_iter().map(with).collect()
}

/// Regions defined by what the camera of a scene sees. Regions with too few pixels are left out.
pub fn seen(scene: &Scene) -> Vec<Region> {
    let [w, h] = scene.camera.size.map(|s| s as usize);
    let looks: Vec<_> =
        (0..w * h).map(|p| scene.camera.ray(p as u32, [0.5; 2])).map(|(o, d)| scene.look(o, d)).collect();
    let surface = |p: usize| looks[p].filter(|v| v.on_surface());
    let lamp = |p: usize| surface(p).is_some_and(|v| scene.emission(v.side) != Rgb::ZERO);
    let reach = (w / 8).max(1) as isize;
    let beside = |p: usize| {
        let (x, y) = ((p % w) as isize, (p / w) as isize);
        let near = |dx: isize, dy: isize| {
            let (x, y) = (x + dx, y + dy);
            x >= 0 && y >= 0 && x < w as isize && y < h as isize && lamp(y as usize * w + x as usize)
        };
        !lamp(p) && (-reach..=reach).any(|dy| (-reach..=reach).any(|dx| near(dx, dy)))
    };
    let set = |name: &str, inside: &dyn Fn(usize) -> bool| Region {
        name: name.into(),
        pixels: (0..w * h).filter(|&p| inside(p)).collect(),
        lamps: vec![],
    };
    let mut regions = vec![
        set("lamps", &lamp),
        set(MIRRORS, &|p| surface(p).is_some_and(|v| scene.bsdf(&v).has_delta())),
        set("grazing", &|p| surface(p).is_some_and(|v| v.n.dot(v.omega) < 0.25)),
        set("beside lamps", &beside),
    ];
    regions.retain(|r| r.pixels.len() >= FEWEST && r.pixels.len() < w * h);
    regions
}

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
