//! BSDFs of a wave of vertices, in SIMD lanes: vertices are sorted by the formula of their surface, and sixteen vertices with
//! the same formula are evaluated at once.
//!
//! | notation | type | place |
//! |---|---|---|
//! | place | position of a path in the sorted order, and of its ray in the buffers | `Rays::order` lists the paths by place |
//! | group | surfaces with one formula | [`Group`](super::faces::Group) |
//! | ρ | reflectance at each vertex, where it differs within a group | `Rays::colour` |
//!
//! The loops call the functions of [`Model`] for one vertex after the other. The compiler turns them into loops over lanes
//! where the formulas allow it, and leaves them as they are where not (Phong's powers). So a BSDF is one file either way, and
//! the bits are those of single vertices.

use super::bsdf::{Bsdf, Model, Sampling, TransportMode, Visitor};
use super::faces::{ColourTable, FEW, Group};
use super::rounding::{offset_origin, segment};
use super::sixteen::{LANES, Lane3, ZERO, ZERO3, get, load, load3, put, store, store3};
use super::vertex::{DELTA, LIGHT, NOTHING, Rays, SOME, Side};
use super::{Scene, Vertex};
use crate::math::{Columns, Rgb, pick};
use glam::Vec3;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// The columns of a wave of vertices.
#[derive(Clone, Copy)]
pub(crate) struct Vertices<'a> {
    pub(crate) p: &'a Columns,
    pub(crate) n: &'a Columns,
    pub(crate) omega: &'a Columns,
    pub(crate) side: &'a [Side],
}

impl Vertices<'_> {
    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> Vertex {
        Vertex { p: self.p.get(i), n: self.n.get(i), omega: self.omega.get(i), side: self.side[i] }
    }
}

impl Scene {
    /// Sorts the first `n` vertices by group into `rays.order`, without those whose group `wanted` rejects, and sets the
    /// reflectances of coloured groups. Returns the number of places. `rays.ends` holds the end of each group.
    ///
    /// A connection and the step after it often sort the same vertices. The second time, comparing their sides is all that is
    /// done: the order depends on nothing else.
    pub(crate) fn sort(&self, at: Vertices, n: usize, rays: &mut Rays, wanted: impl Fn(&Bsdf) -> bool) -> usize {
        // group 0 is black
        let all = self.faces.groups().iter().enumerate();
        let wants: Vec<bool> = all.map(|(g, group)| g != 0 && wanted(&group.bsdf)).collect();
        let alike = n > 0 && rays.sorted.as_slice() == &at.side[..n];
        let known = alike && rays.wants == wants && self.textures.is_none();
        if !known {
            rays.sorted.clear();
            rays.sorted.extend_from_slice(&at.side[..n]);
            rays.places = self.sort_anew(at, n, rays, &wants);
            rays.wants = wants;
        }
        rays.places
    }

    fn sort_anew(&self, at: Vertices, n: usize, rays: &mut Rays, wants: &[bool]) -> usize {
        let side = &at.side[..n];
        match self.faces.groups_by_side() {
            Some(table) => groups_in_lanes(table, side, &mut rays.group[..n]),
            None => rays.group.iter_mut().zip(side).for_each(|(g, &side)| *g = self.faces.group_of(side)),
        }
        rays.ends.clear();
        rays.ends.resize(wants.len(), 0);
        let groups = &rays.group[..n];
        let few = if pick::lists_at_once() { FEW_GROUPS } else { 2 };
        let sort = if wants.len() <= few { list_by_list } else { counting_sort };
        let places = sort(groups, wants, &mut rays.order, &mut rays.ends);
        self.colours(at, rays);
        places
    }

    /// The reflectance of every vertex in a coloured group.
    fn colours(&self, at: Vertices, rays: &mut Rays) {
        for g in (1..self.faces.groups().len()).filter(|&g| self.faces.groups()[g].coloured) {
            let places = rays.ends[g - 1] as usize..rays.ends[g] as usize;
            if let (Some(table), None) = (self.faces.colours(), &self.textures) {
                colours_in_lanes(table, at.side, &rays.order, &mut rays.colour, places);
                continue;
            }
            for place in places {
                let i = rays.order[place] as usize;
                let rho = match self.textures {
                    None => self.faces.of(at.side[i]).colour,
                    Some(_) => self.colour_at(at.side[i], at.p.get(i)),
                };
                rays.colour.set(place, rho);
            }
        }
    }

    /// Calls `work` with each group that has vertices, and its places.
    fn each_group(&self, rays: &mut Rays, mut work: impl FnMut(&Group, Range<usize>, &mut Rays)) {
        for g in 1..self.faces.groups().len() {
            let places = rays.ends[g - 1] as usize..rays.ends[g] as usize;
            if !places.is_empty() {
                work(&self.faces.groups()[g], places, rays);
            }
        }
    }

    /// Samples a direction at every sorted vertex, from the random numbers `rays.u` of its path. Writes by place: the ray to
    /// `rays.o` and `rays.d`, the weight, the density and whether there is a sample to `rays.value`, `rays.t`, `rays.flag`.
    pub(crate) fn depart(&self, at: Vertices, rays: &mut Rays, sampling: Sampling, mode: TransportMode) {
        self.each_group(rays, |group, places, rays| {
            group.bsdf.welcome(Depart { at, rays, places, coloured: group.coloured, sampling, mode });
        });
    }

    /// Evaluates the BSDF of every sorted vertex for its light point, given by place in `rays.to`, `rays.t` (density) and
    /// `rays.q`, `rays.m` (position and normal), `rays.radiance`, `rays.prim` (1 if a ray can hit the light). Writes by place:
    /// the shadow segment to `rays.o` and `rays.d`, the radiance times its weight to `rays.value`, the density of scattering
    /// to `rays.cosine`, and whether there is a contribution to `rays.flag`.
    pub(crate) fn connect(&self, at: Vertices, rays: &mut Rays, sampling: Sampling) {
        self.each_group(rays, |group, places, rays| {
            group.bsdf.welcome(Connect { at, rays, places, coloured: group.coloured, sampling });
        });
    }
}

/// Up to so many groups, with the black one, are listed one after the other where a list costs little.
const FEW_GROUPS: usize = 9;

/// Lists the members of all groups that are wanted, group by group, and the end of each group. Returns the number of members. There is
/// one pass for each group.
fn list_by_list(groups: &[u32], wants: &[bool], order: &mut [u32], ends: &mut [u32]) -> usize {
    let mut places = 0;
    for (g, (end, wanted)) in (0..).zip(ends.iter_mut().zip(wants)) {
        if *wanted {
            places += pick::list_equal(&mut order[places..], groups, g);
        }
        *end = places as u32;
    }
    places
}

/// The same in two passes for any number of groups. `ends` holds zeros.
fn counting_sort(groups: &[u32], wants: &[bool], order: &mut [u32], ends: &mut [u32]) -> usize {
    for &g in groups {
        ends[g as usize] += u32::from(wants[g as usize]);
    }
    let mut start = 0;
    for end in ends.iter_mut() {
        (*end, start) = (start, start + *end);
    }
    for (i, &g) in (0..).zip(groups) {
        if wants[g as usize] {
            order[ends[g as usize] as usize] = i;
            ends[g as usize] += 1;
        }
    }
    start as usize
}

/// The group of each side; 0 if it is not on a surface.
#[pulp::with_simd(groups_in_lanes = Arch::new())]
#[inline(always)]
fn groups_in_lanes_with_simd<'a, S: Simd>(_simd: S, table: &'a [u32; FEW], side: &'a [Side], group: &'a mut [u32]) {
    for (group, &side) in group.iter_mut().zip(side) {
        let of = table[side as usize % FEW];
        *group = if side < LIGHT { of } else { 0 };
    }
}

#[inline(always)]
pub(super) fn gather<X: Copy + Default>(column: &[X], at: &Paths) -> [X; LANES] {
    let mut lane = [X::default(); LANES];
    if at.neighbours {
        lane.copy_from_slice(&column[at.list[0] as usize..][..LANES]);
    } else {
        for (lane, &i) in lane.iter_mut().zip(&at.list) {
            *lane = column[i as usize];
        }
    }
    lane
}

#[inline(always)]
pub(super) fn gather3(c: &Columns, at: &Paths) -> Lane3 {
    [gather(&c.x, at), gather(&c.y, at), gather(&c.z, at)]
}

/// The paths at sixteen places.
pub(super) struct Paths {
    pub(super) list: [u32; LANES],
    /// True if they are neighbours in the wave, as they usually are.
    pub(super) neighbours: bool,
}

/// The paths at sixteen places from `place` on; after the last place before `end`, the last path again.
#[inline(always)]
pub(super) fn paths(order: &[u32], place: usize, end: usize) -> Paths {
    if place + LANES <= end {
        let mut list = [0; LANES];
        list.copy_from_slice(&order[place..place + LANES]);
        let mut neighbours = true;
        for i in 0..LANES {
            neighbours &= list[i] == list[0] + i as u32;
        }
        return Paths { neighbours, list };
    }
    Paths { list: std::array::from_fn(|i| order[(place + i).min(end - 1)]), neighbours: false }
}

/// The reflectance of every vertex at these places, by its side.
#[pulp::with_simd(colours_in_lanes = Arch::new())]
#[inline(always)]
fn colours_in_lanes_with_simd<'a, S: Simd>(
    _simd: S,
    table: &'a ColourTable,
    side: &'a [Side],
    order: &'a [u32],
    colour: &'a mut Columns,
    places: Range<usize>,
) {
    for place in places.clone().step_by(LANES) {
        let list = paths(order, place, places.end);
        let sides = gather(side, &list);
        for (to, table) in [&mut colour.x, &mut colour.y, &mut colour.z].into_iter().zip(table) {
            let mut lane = ZERO;
            for i in 0..LANES {
                lane[i] = table[sides[i] as usize % FEW];
            }
            store(to, place, &lane);
        }
    }
}

struct Depart<'a, 'r> {
    at: Vertices<'a>,
    rays: &'r mut Rays,
    places: Range<usize>,
    coloured: bool,
    sampling: Sampling,
    mode: TransportMode,
}

struct With<T, M>(T, M);

impl Visitor for Depart<'_, '_> {
    type Out = ();
    fn visit<M: Model>(self, f: &M) {
        Arch::new().dispatch(With(self, *f));
    }
}

impl<M: Model> WithSimd for With<Depart<'_, '_>, M> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let With(Depart { at, rays, places, coloured, sampling, mode }, f) = self;
        for place in places.clone().step_by(LANES) {
            let list = paths(&rays.order, place, places.end);
            let (p, n, omega) = (gather3(at.p, &list), gather3(at.n, &list), gather3(at.omega, &list));
            let u = [gather(&rays.u[0], &list), gather(&rays.u[1], &list), gather(&rays.u[2], &list)];
            let rho = load3(&rays.colour, place);
            let (mut o, mut d, mut weight) = (ZERO3, ZERO3, ZERO3);
            let (mut pdf, mut flag) = (ZERO, [NOTHING; LANES]);
            for i in 0..LANES {
                let f = if coloured { f.with_reflectance(get(&rho, i)) } else { f };
                let n = get(&n, i);
                let sample = f.depart(n, get(&omega, i), sampling, mode, [u[0][i], u[1][i], u[2][i]]);
                if let Some(s) = sample {
                    put(&mut o, i, offset_origin(get(&p, i), s.normal));
                    put(&mut d, i, s.direction);
                    put(&mut weight, i, s.weight);
                    pdf[i] = s.pdf;
                    flag[i] = if s.delta { DELTA } else { SOME };
                }
            }
            store3(&mut rays.o, place, &o);
            store3(&mut rays.d, place, &d);
            store3(&mut rays.value, place, &weight);
            store(&mut rays.t, place, &pdf);
            rays.flag[place..place + LANES].copy_from_slice(&flag);
        }
    }
}

struct Connect<'a, 'r> {
    at: Vertices<'a>,
    rays: &'r mut Rays,
    places: Range<usize>,
    coloured: bool,
    sampling: Sampling,
}

impl Visitor for Connect<'_, '_> {
    type Out = ();
    fn visit<M: Model>(self, f: &M) {
        Arch::new().dispatch(With(self, *f));
    }
}

impl<M: Model> WithSimd for With<Connect<'_, '_>, M> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let With(Connect { at, rays, places, coloured, sampling }, f) = self;
        for place in places.clone().step_by(LANES) {
            let list = paths(&rays.order, place, places.end);
            let (p, n, omega) = (gather3(at.p, &list), gather3(at.n, &list), gather3(at.omega, &list));
            let (to, q, m) = (load3(&rays.to, place), load3(&rays.q, place), load3(&rays.m, place));
            let (density, rho) = (load(&rays.t, place), load3(&rays.colour, place));
            let (radiance, hittable) = (load3(&rays.radiance, place), &rays.prim[place..place + LANES]);
            let (mut o, mut d, mut value) = (ZERO3, ZERO3, ZERO3);
            let (mut pdf, mut flag) = (ZERO, [NOTHING; LANES]);
            for i in 0..LANES {
                let f = if coloured { f.with_reflectance(get(&rho, i)) } else { f };
                let found = f.connect(get(&n, i), get(&omega, i), get(&to, i), density[i], sampling);
                // a density of 0 or less: the light faces away; an infinite one: it is seen exactly edge-on
                let seen = (density[i] > 0.0) & (density[i] < f32::INFINITY);
                if let Some(found) = found {
                    let (start, along) = segment(get(&p, i), found.normal, get(&q, i), get(&m, i));
                    put(&mut o, i, start);
                    put(&mut d, i, along);
                    put(&mut value, i, found.value * get(&radiance, i));
                    pdf[i] = if hittable[i] != 0 { found.pdf } else { 0.0 };
                    flag[i] = if seen { SOME } else { NOTHING };
                }
            }
            store3(&mut rays.o, place, &o);
            store3(&mut rays.d, place, &d);
            store3(&mut rays.value, place, &value);
            store(&mut rays.cosine, place, &pdf);
            rays.flag[place..place + LANES].copy_from_slice(&flag);
        }
    }
}

impl Scene {
    /// The reflectance of a side at a point `p`: from its image, or of its Lambertian surface; white for other kinds.
    #[inline(always)]
    fn colour_at(&self, side: Side, p: Vec3) -> Rgb {
        let prim = side / 2;
        if let Some(t) = &self.textures
            && let Some(rho) = t.reflectance(prim, &self.accel.shapes[prim as usize], p)
        {
            return rho;
        }
        self.faces.of(side).colour
    }
}

#[cfg(test)]
mod tests {
    use super::{counting_sort, list_by_list};

    /// Both ways to sort give the members of each group that is wanted, in ascending order.
    #[test]
    fn groups_are_sorted_in_order() {
        for n in [0_u32, 1, 17, 1000] {
            for wants in [vec![false, true], vec![false, false], vec![false, true, false, true, true]] {
                let groups: Vec<u32> =
                    (0..n).map(|i| (i.wrapping_mul(2_654_435_761) >> 16) % wants.len() as u32).collect();
                let (mut truth, mut bounds) = (vec![], vec![]);
                for (g, wanted) in (0..).zip(&wants) {
                    truth.extend((0..n).filter(|&i| *wanted && groups[i as usize] == g));
                    bounds.push(truth.len() as u32);
                }
                for sort in [list_by_list, counting_sort] {
                    let (mut order, mut ends) = (vec![0; n as usize + 16], vec![0; wants.len()]);
                    let places = sort(&groups, &wants, &mut order, &mut ends);
                    assert_eq!((&order[..places], &ends), (truth.as_slice(), &bounds));
                }
            }
        }
    }
}
