//! What the sides of a shape are made of: the same for all its primitives, so that a mesh stores it once.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | f | BSDF of a side; white if its colour comes from an image | [`Face::bsdf`] |
//! | albedo | largest albedo over all directions and, for an image, all its texels | [`Face::albedo`] |
//! | E | emitted radiance | [`Face::emission`] |
//! | group | sides with one formula, which a wave of paths evaluates together | [`Face::group`] |

use super::bsdf::Bsdf;
use super::bsdf::diffuse::Diffuse;
use super::description::Description;
use super::primitive::Primitive;
use super::vertex::{LIGHT, Side};
use crate::math::Rgb;

/// One side of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face {
    pub(crate) bsdf: Bsdf,
    pub(crate) albedo: Rgb,
    pub(crate) emission: Rgb,
    pub(crate) takes_part: bool,
    /// Reflectance if the side is Lambertian and has no image; otherwise white.
    pub(crate) colour: Rgb,
    /// Number of its group.
    pub(crate) group: u32,
}

/// Sides whose BSDFs differ at most by the colour that an image gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Group {
    /// The BSDF, which is white if `coloured`.
    pub(crate) bsdf: Bsdf,
    /// True if the reflectance is looked up for each point: from an image, or from the side for Lambertian surfaces.
    pub(crate) coloured: bool,
}

/// Number of sides up to which a table by side is kept.
pub(crate) const FEW: usize = 512;
/// Reflectances by side, one row per channel.
pub(crate) type ColourTable = [[f32; FEW]; 3];

/// The sides of all shapes: number 2·shape, plus 1 for the back.
#[derive(Clone, Debug, Default)]
pub(crate) struct Faces {
    faces: Vec<Face>,
    /// For every primitive, twice the number of its shape.
    of_prim: Vec<u32>,
    /// Group 0 is black: sides that scatter nothing, and vertices that are not on a surface.
    groups: Vec<Group>,
    /// [`Face::colour`] and [`Face::emission`] by side, if there are few.
    colours: Option<Box<ColourTable>>,
    emissions: Option<Box<ColourTable>>,
    /// [`Face::group`] by side, if there are few.
    group_by_side: Option<Box<[u32; FEW]>>,
}

impl Faces {
    /// The sides of the shapes in `prims`. `brightest` is the largest reflectance in the image of a primitive, if it has one.
    pub(crate) fn new(
        description: &Description,
        prims: &[(usize, Primitive)],
        brightest: impl Fn(usize) -> Option<Rgb>,
    ) -> Self {
        let mut all = Self { groups: vec![Group { bsdf: Bsdf::Black, coloured: false }], ..Self::default() };
        all.of_prim = prims.iter().map(|(shape, _)| 2 * *shape as u32).collect();
        let mut first = vec![None; description.shapes.len()];
        prims.iter().enumerate().rev().for_each(|(i, (shape, _))| first[*shape] = Some(i));
        for (shape, first) in description.shapes.iter().zip(first) {
            let material = &description.materials[shape.material];
            let image = first.and_then(&brightest);
            for back in [false, true] {
                let takes_part = !back || material.both_sides();
                let bsdf = if takes_part { Bsdf::new(&material.bsdf, back) } else { Bsdf::Black };
                let group = all.group(bsdf, image.is_some());
                all.faces.push(Face {
                    bsdf,
                    albedo: image.map_or(bsdf, |rho| bsdf.with_reflectance(rho)).max_albedo(),
                    emission: if back { Rgb::ZERO } else { shape.emission.as_vec3() },
                    takes_part,
                    colour: if let Bsdf::Diffuse(f) = bsdf { f.reflectance } else { Rgb::ONE },
                    group,
                });
            }
        }
        if all.sides() as usize <= FEW {
            all.colours = Some(all.by_side(|face| face.colour));
            all.emissions = Some(all.by_side(|face| face.emission));
            let group = |side: usize| if side < all.sides() as usize { all.of(side as u32).group } else { 0 };
            all.group_by_side = Some(Box::new(std::array::from_fn(group)));
        }
        all
    }

    fn by_side(&self, colour: impl Fn(&Face) -> Rgb) -> Box<ColourTable> {
        let mut table = Box::new([[0.0; FEW]; 3]);
        for side in 0..self.sides() {
            table.iter_mut().zip(colour(self.of(side)).to_array()).for_each(|(row, c)| row[side as usize] = c);
        }
        table
    }

    /// [`Face::emission`] by side, if there are few sides.
    pub(crate) fn emissions(&self) -> Option<&ColourTable> {
        self.emissions.as_deref()
    }

    /// [`Face::colour`] by side, if there are few sides.
    pub(crate) fn colours(&self) -> Option<&ColourTable> {
        self.colours.as_deref()
    }

    /// The group of a BSDF; a new one if there is none yet.
    fn group(&mut self, bsdf: Bsdf, image: bool) -> u32 {
        let group = match bsdf {
            Bsdf::Diffuse(_) => Group { bsdf: Diffuse { reflectance: Rgb::ONE }.into(), coloured: true },
            bsdf => Group { bsdf, coloured: image && bsdf != Bsdf::Black },
        };
        let known = self.groups.iter().position(|g| *g == group);
        known.unwrap_or_else(|| {
            self.groups.push(group);
            self.groups.len() - 1
        }) as u32
    }

    /// The face of a side of a primitive.
    #[inline(always)]
    pub(crate) fn of(&self, side: Side) -> &Face {
        &self.faces[(self.of_prim[(side / 2) as usize] | side & 1) as usize]
    }

    /// The group of a side; 0 if it is not on a surface.
    #[inline(always)]
    pub(crate) fn group_of(&self, side: Side) -> u32 {
        if side < LIGHT { self.of(side).group } else { 0 }
    }

    /// [`Face::group`] by side, if there are few sides.
    pub(crate) fn groups_by_side(&self) -> Option<&[u32; FEW]> {
        self.group_by_side.as_deref()
    }

    /// All groups; the first is black.
    pub(crate) fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// All faces, including those of shapes without primitives.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Face> {
        self.faces.iter()
    }

    /// Number of sides of primitives.
    pub(crate) fn sides(&self) -> u32 {
        2 * self.of_prim.len() as u32
    }
}
