//! Sensors, at which paths start: the pinhole camera and the surface sensor.
//!
//! | sensor | measures | mean over all samples |
//! |---|---|---|
//! | [`Camera`] | radiance towards the eye, uniform over the square of a pixel | the image mean |
//! | [`SurfaceSensor`] | radiance that leaves a uniform surface point in a cosine-distributed direction | `∫ L cos θ dω dA / (πA)`: the L1 norm in the throughput measure, divided by πA |

use super::sixteen::{LANES, ZERO3, load, put, store3};
use super::{Crop, Rays, Scene, Vertex, description::CameraDescription};
use crate::math::{Rng, direction::cosine_hemisphere};
use glam::{DVec3, Vec3};

/// A pinhole camera. Pixel (0, 0) is top left; right = forward × up; pixels are square.
///
/// Camera rays are computed in `f64`. For a distant camera they start where they enter a sphere around the scene. So the
/// camera may be at any distance, and its pixels may be as narrow as `f64` can resolve.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// The pinhole, relative to the middle of the scene, m.
    pub origin: DVec3,
    /// Direction to the top left corner of the image; `across` and `down` are the steps of one pixel to the right and down.
    corner: DVec3,
    across: DVec3,
    down: DVec3,
    /// Unit directions of the image: right, down, forward.
    axes: [DVec3; 3],
    /// Width of a pixel at distance 1.
    width: f64,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// The pixels of the picture that a film holds.
    pub crop: Crop,
    /// Centre and radius of a sphere that encloses the shapes.
    center: DVec3,
    radius: f64,
    /// True if the pinhole is at most three radii from the middle, so that rays may start there without loss of precision.
    near: bool,
}

impl Camera {
    /// The camera of a description, for a scene inside the sphere of this centre and radius.
    pub fn new(c: &CameraDescription, center: DVec3, radius: f64) -> Self {
        let forward = (c.target - c.origin).normalize();
        let right = forward.cross(c.up).normalize();
        let up = right.cross(forward);
        let half = (0.5 * c.fov).to_radians().tan();
        let width = 2.0 * half / f64::from(c.size[0]);
        Self {
            origin: c.origin,
            corner: forward - right * half + up * (0.5 * width * f64::from(c.size[1])),
            across: right * width,
            down: -up * width,
            axes: [right, -up, forward],
            width,
            size: c.size,
            crop: Crop::whole(c.size),
            center,
            // slightly enlarged, so that no surface lies in front of the start of a ray
            radius: radius * 1.001,
            near: c.origin.distance(center) <= 3.0 * radius,
        }
    }

    /// The same camera, for a film with some pixels of the picture.
    pub fn cropped(self, crop: Option<Crop>) -> Self {
        Self { crop: crop.unwrap_or(self.crop), ..self }
    }

    /// The pixel that sees the direction `d` (of any length), and the density per solid angle with which its paths take that
    /// direction. The pixel is `None` if `d` is outside the image; the result is `None` if `d` points backwards. The density
    /// is the inverse of the pixel's solid angle in this direction: `l³/|pixel|²`, with l the length of `d` up to the plane
    /// at distance 1.
    #[inline(always)]
    pub(crate) fn pixel(&self, d: DVec3) -> Option<(Option<u32>, f32)> {
        let [right, down, forward] = self.axes;
        let along = d.dot(forward);
        if along <= 0.0 {
            return None;
        }
        let at_one = d * (1.0 / along);
        let (q, per_pixel) = (at_one - self.corner, 1.0 / self.width);
        let (x, y) = (q.dot(right) * per_pixel, q.dot(down) * per_pixel);
        let inside = x >= 0.0 && y >= 0.0 && x < f64::from(self.size[0]) && y < f64::from(self.size[1]);
        let l2 = at_one.length_squared();
        let per_angle = l2 * l2.sqrt() * (per_pixel * per_pixel);
        Some((inside.then(|| y as u32 * self.size[0] + x as u32), per_angle as f32))
    }

    /// Start and unit direction of the ray through a point of a pixel; `u` in [0, 1)² is measured from the pixel's top left
    /// corner.
    #[inline(always)]
    pub fn ray(&self, pixel: u32, u: [f32; 2]) -> (Vec3, Vec3) {
        let (number, width) = (f64::from(pixel), f64::from(self.size[0]));
        let row = row(number, width);
        let (x, y) = (number - row * width + f64::from(u[0]), row + f64::from(u[1]));
        let d = self.corner + self.across * x + self.down * y;
        let d = d * (1.0 / d.dot(d).sqrt());
        (self.enter(d), d.as_vec3())
    }

    /// The point where the ray from the pinhole in the unit direction `d` comes near the scene. It is the pinhole itself if
    /// that is near.
    #[inline(always)]
    pub(crate) fn enter(&self, d: DVec3) -> Vec3 {
        if self.near {
            return self.origin.as_vec3();
        }
        let to = self.center - self.origin;
        let (along, r2) = (to.dot(d), self.radius * self.radius);
        let before = along - (r2 - (to - d * along).length_squared()).max(0.0).sqrt();
        // a part of the sphere behind the camera does not move the start backwards
        (self.origin + d * before.max(0.0)).as_vec3()
    }
}

/// The row of a pixel. Its middle is half a pixel away from the next row, which rounding cannot reach. The reciprocal is computed
/// once for many pixels, and integer divisions would not vectorise.
#[inline(always)]
fn row(number: f64, width: f64) -> f64 {
    f64::from(((number + 0.5) * (1.0 / width)) as u32)
}

/// [`Camera::ray`] for each of these pixels, from the first two columns of random numbers: rays into `rays.o` and `rays.d`.
#[pulp::with_simd(camera_rays = pulp::Arch::new())]
#[inline(always)]
pub(crate) fn camera_rays_with_simd<'a, S: pulp::Simd>(
    _simd: S,
    camera: &'a Camera,
    pixel: &'a [u32],
    rays: &'a mut Rays,
) {
    for (at, few) in pixel.chunks(LANES).enumerate().map(|(i, few)| (i * LANES, few)) {
        let mut pixel = [0; LANES];
        pixel[..few.len()].copy_from_slice(few);
        let (u, v) = (load(&rays.u[0], at), load(&rays.u[1], at));
        let (mut start, mut along) = (ZERO3, ZERO3);
        for i in 0..LANES {
            let (o, d) = camera.ray(pixel[i], [u[i], v[i]]);
            put(&mut start, i, o);
            put(&mut along, i, d);
        }
        store3(&mut rays.o, at, &start);
        store3(&mut rays.d, at, &along);
    }
}

/// A sensor without a camera: all sides of all surfaces, with points uniform by area and cosine-distributed directions.
#[derive(Clone, Debug)]
pub struct SurfaceSensor {
    sides: Vec<u32>,
    /// Cumulative fraction of the area.
    cdf: Vec<f64>,
    /// Area of all sides that take part in light transport, m².
    pub area: f64,
}

impl SurfaceSensor {
    /// All sides that take part in light transport: both of a two-sided surface, else the front.
    pub fn new(scene: &Scene) -> Self {
        Self::of(scene, (0..scene.sides()).filter(|&s| scene.takes_part(s)).collect())
    }

    /// These sides only.
    pub fn of(scene: &Scene, sides: Vec<u32>) -> Self {
        let areas: Vec<f64> = sides.iter().map(|&s| scene.area(s)).collect();
        let area = areas.iter().sum();
        let mut up_to = 0.0;
        let cdf = areas.iter().map(|a| {
            up_to += a / area;
            up_to
        });
        Self { cdf: cdf.collect(), sides, area }
    }

    /// A uniformly distributed point with a cosine-distributed direction.
    pub fn vertex(&self, scene: &Scene, rng: &mut Rng) -> Vertex {
        let (u, w) = (rng.four(), rng.four());
        // 48 bits choose the side, so that small sides are chosen with their exact probability
        let share = f64::from(u[0]) + f64::from(u[1]) / 16_777_216.0;
        let side = self.sides[self.cdf.partition_point(|&c| c <= share).min(self.sides.len() - 1)];
        let (p, n) = scene.point(side, [u[2], u[3]]);
        Vertex { p, n, omega: cosine_hemisphere(n, [w[0], w[1]]).0, side }
    }
}

#[cfg(test)]
mod tests {
    /// The first and the last pixel of every kind of row, up to the largest numbers.
    #[test]
    fn rows_are_those_of_integers() {
        for width in (1..2000).chain([4095, 65_535, 99_991, 1 << 20, 3_000_001, u32::MAX]) {
            let rows = u32::MAX / width;
            for row in [0, 1, 2, 3, rows / 3, rows / 2, rows - rows.min(1)] {
                for pixel in [row * width, row * width + width / 2, row * width + width - 1] {
                    assert_eq!(super::row(f64::from(pixel), f64::from(width)), f64::from(pixel / width));
                }
            }
        }
    }
}
