//! Classification of coincident shapes: one lies in front, both look the same, or the visible one is undefined.
//!
//! ```text
//! in front   one emits and the other does not, or both emit and their fronts face opposite directions
//! alike      otherwise, if on both sides the two scatter and emit the same way
//! differ     otherwise: which one is visible is undefined, and this matters wherever a path can land there
//! ```
//!
//! Coincident glass surfaces are never alike, because a ray crosses every one of them, so their number matters. Textured
//! surfaces are alike only if the two shapes have the same geometry, so that the image lies at the same place.

use super::{Surfaces, find};
use crate::math::polygon::{clip, uniform};
use crate::scene::description::{BsdfDescription, Colour, Description, DiffuseSurface};
use crate::scene::primitive::Primitive;
use crate::scene::vertex::Side;
use glam::DVec3;
use std::collections::BTreeMap;

/// Class of a pair of coincident shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Both look the same. Images are right, but the surface counts twice in areas and in norms over all surfaces.
    Alike,
    /// An emitter lies in front of the other surface.
    InFront,
    /// They look different, and the renderer cannot decide which one is visible.
    Differ,
}

/// A pair of coincident shapes, or one shape that coincides with itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Relation {
    /// Indices of the two shapes, ascending.
    pub shapes: [usize; 2],
    /// Names of the two shapes in messages.
    pub names: [String; 2],
    /// The worst class among all pairs of their primitives.
    pub kind: Kind,
    /// The parts of the surface where they look different.
    pub regions: Vec<Region>,
}

/// A part of a surface where two coincident sides look different.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The two sides; both face the same half space.
    pub sides: [Side; 2],
    /// γ of the surface (m): the tolerance.
    pub gap: f64,
    part: Part,
}

#[derive(Clone, Debug, PartialEq)]
enum Part {
    /// A convex polygon, counter-clockwise as seen from the half space that the sides face.
    Flat(Vec<DVec3>),
    /// A band of a sphere; `out` is true if the sides face outwards.
    Band { center: DVec3, radius: f64, z: [f64; 2], out: bool },
}

impl Region {
    /// The point at `u` in [0, 1)², uniform by area, and the unit normal towards the half space that sees it.
    pub fn point(&self, u: [f64; 2]) -> (DVec3, DVec3) {
        match &self.part {
            Part::Flat(p) => (uniform(p, u[0], u[1]), crate::math::polygon::area_vector(p).normalize()),
            Part::Band { center, radius, z, out } => {
                let z = z[0] + u[0] * (z[1] - z[0]);
                let ((sin, cos), r) = ((std::f64::consts::TAU * u[1]).sin_cos(), (1.0 - z * z).max(0.0).sqrt());
                let n = DVec3::new(r * cos, r * sin, z);
                (*center + *radius * n, if *out { n } else { -n })
            }
        }
    }

    /// Returns true if the region is part of a plane.
    pub fn is_flat(&self) -> bool {
        matches!(self.part, Part::Flat(_))
    }

    /// Returns true if the point `x` of one of the two surfaces lies in the region that they share.
    pub fn holds(&self, x: DVec3) -> bool {
        match &self.part {
            Part::Flat(p) => {
                let n = crate::math::polygon::area_vector(p);
                let edges = p.iter().zip(p.iter().cycle().skip(1));
                edges.into_iter().all(|(a, b)| n.cross(*b - *a).dot(x - *a) >= 0.0)
            }
            Part::Band { center, radius, z, .. } => {
                let h = (x - *center).z / radius;
                h >= z[0] && h <= z[1]
            }
        }
    }
}

/// Appearance of one side: its emission and its scattering.
#[derive(PartialEq)]
struct Look<'a> {
    emission: DVec3,
    /// `None` for a black side.
    bsdf: Option<&'a BsdfDescription>,
}

impl Description {
    fn look(&self, shape: usize, side: usize) -> Look<'_> {
        let shape = &self.shapes[shape];
        let material = &self.materials[shape.material];
        let reflects = side == 0 || material.both_sides();
        Look {
            emission: if side == 0 { shape.emission } else { DVec3::ZERO },
            bsdf: reflects.then_some(&material.bsdf).filter(|b| !black(b)),
        }
    }

    /// Returns true if two coincident sides look the same.
    fn alike(&self, shapes: [usize; 2], sides: [usize; 2]) -> bool {
        let [a, b] = [0, 1].map(|i| self.look(shapes[i], sides[i]));
        let counts = a.bsdf.is_some_and(BsdfDescription::lets_through);
        let same_place = || {
            let [s, t] = shapes.map(|s| &self.shapes[s].geometry);
            shapes[0] != shapes[1] && s == t
        };
        a == b && !counts && (!a.bsdf.is_some_and(textured) || same_place())
    }

    /// The name of a shape, followed by its number if another shape has the same name.
    fn shape_name(&self, i: usize) -> String {
        let name = &self.shapes[i].name;
        let alone = self.shapes.iter().filter(|s| s.name == *name).count() == 1;
        if alone { name.clone() } else { format!("{name} (shape {i})") }
    }
}

fn black(bsdf: &BsdfDescription) -> bool {
    matches!(bsdf, BsdfDescription::Diffuse(DiffuseSurface { reflectance: Colour::Uniform(DVec3::ZERO) }))
}

fn textured(bsdf: &BsdfDescription) -> bool {
    bsdf.colour().is_some_and(Colour::is_texture)
}

impl Surfaces {
    /// The relations of class [`Kind::Differ`], for which no image is right.
    pub fn conflicts(&self, of: &Description) -> Vec<Relation> {
        self.relations(of).into_iter().filter(|r| r.kind == Kind::Differ).collect()
    }

    /// The class of every pair of coincident shapes, in ascending order of the pairs.
    pub fn relations(&self, of: &Description) -> Vec<Relation> {
        let mut all: BTreeMap<[usize; 2], (Kind, Vec<Region>)> = BTreeMap::new();
        // sides are compared once per pair of shapes, not for every pair of triangles, because they may have images
        let mut known: BTreeMap<([usize; 2], [usize; 2]), bool> = BTreeMap::new();
        for o in &self.overlaps {
            let shapes = o.pair.map(|i| self.list[i].0);
            let [a, b] = shapes.map(|s| of.shapes[s].emission.max_element() > 0.0);
            // primitives are listed shape by shape, so the shapes of an ascending pair ascend
            let (kind, regions) = all.entry(shapes).or_insert((Kind::Alike, vec![]));
            if a != b || (a && !o.same_way) {
                *kind = (*kind).max(Kind::InFront);
                continue;
            }
            for from_front in [true, false] {
                let sides = o.sides(from_front);
                if *known.entry((shapes, sides)).or_insert_with(|| of.alike(shapes, sides)) {
                    continue;
                }
                *kind = Kind::Differ;
                let part = shared(o.pair.map(|i| &self.list[i].1), from_front);
                let sides = [0, 1].map(|i| 2 * o.pair[i] as Side + sides[i] as Side);
                regions.extend(part.map(|part| Region { sides, gap: o.gap, part }));
            }
        }
        let relation = |(shapes, (kind, regions)): ([usize; 2], (Kind, Vec<Region>))| Relation {
            names: shapes.map(|s| of.shape_name(s)),
            shapes,
            kind,
            regions,
        };
        all.into_iter().map(relation).collect()
    }
}

/// The overlap of two primitives, as seen from the front of the first or from its back.
fn shared([a, b]: [&Primitive; 2], from_front: bool) -> Option<Part> {
    if let (&Primitive::Sphere { center, radius, z, inward }, &Primitive::Sphere { z: w, .. }) = (a, b) {
        let z = [z[0].max(w[0]), z[1].min(w[1])];
        return Some(Part::Band { center, radius, z, out: inward != from_front });
    }
    let (mut p, _) = find::outline(a)?;
    let (q, m) = find::outline(b)?;
    let mut rest = Vec::with_capacity(p.len() + q.len());
    for (i, &x) in q.iter().enumerate() {
        let normal = m.cross(q[(i + 1) % q.len()] - x).normalize();
        clip(&p, normal, normal.dot(x), 0.0, &mut rest);
        std::mem::swap(&mut p, &mut rest);
    }
    if !from_front {
        p.reverse();
    }
    (p.len() > 2).then_some(Part::Flat(p))
}
