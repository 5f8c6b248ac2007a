//! Reflectance from images: the image of each primitive, and the texture coordinates of a point.
//!
//! (u, v) runs along the edges of a parallelogram. On a triangle it is interpolated from its corners with barycentric
//! weights.

use super::description::{Colour, Description, Geometry};
use super::primitive::Primitive;
use super::raster::Raster;
use super::shape::Shape;
use crate::math::Rgb;
use glam::Vec3;
use std::sync::Arc;

pub(crate) struct Textures {
    images: Vec<Arc<Raster>>,
    /// For every primitive with a texture: the number of its image, and the texture coordinates of a triangle's corners.
    of_prim: Vec<Option<(usize, [[f32; 2]; 3])>>,
}

impl Textures {
    /// Collects the images of a scene; `None` if no material has a texture.
    pub(crate) fn new(description: &Description, prims: &[(usize, Primitive)]) -> Option<Self> {
        let image = |shape: &super::description::Shape| description.materials[shape.material].bsdf.colour();
        if !description.shapes.iter().any(|s| image(s).is_some_and(Colour::is_texture)) {
            return None;
        }
        let mut all = Self { images: vec![], of_prim: vec![None; prims.len()] };
        let mut first = 0;
        for (number, shape) in description.shapes.iter().enumerate() {
            let count = prims[first..].iter().take_while(|(s, _)| *s == number).count();
            if let Some(Colour::Texture(image)) = image(shape) {
                let known = all.images.iter().position(|i| Arc::ptr_eq(i, image));
                let image = known.unwrap_or_else(|| {
                    all.images.push(image.clone());
                    all.images.len() - 1
                });
                for i in 0..count {
                    let uvs = match &shape.geometry {
                        Geometry::Mesh { uvs, .. } if !uvs.is_empty() => uvs[i].map(|uv| uv.as_vec2().to_array()),
                        _ => [[0.0; 2]; 3],
                    };
                    all.of_prim[first + i] = Some((image, uvs));
                }
            }
            first += count;
        }
        (!all.images.is_empty()).then_some(all)
    }

    /// The colour of the image at a point of a primitive; `None` if the primitive has no image.
    pub(crate) fn reflectance(&self, prim: u32, shape: &Shape, p: Vec3) -> Option<Rgb> {
        let (image, [a, b, c]) = self.of_prim[prim as usize]?;
        let w = shape.coordinates(p);
        let uv = match shape {
            Shape::Triangle(_) => [0, 1].map(|i| a[i] * w[0] + b[i] * w[1] + c[i] * w[2]),
            _ => [w[0], w[1]],
        };
        Some(self.images[image].bilinear(uv))
    }

    /// The largest value per channel in the image of a primitive; `None` if it has no image.
    pub(crate) fn brightest(&self, prim: usize) -> Option<Rgb> {
        let (image, _) = self.of_prim[prim]?;
        Some(self.images[image].texels.iter().fold(Rgb::ZERO, |a, &b| a.max(b)))
    }
}
