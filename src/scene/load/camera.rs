//! Reading of the camera of a scene file, and placement of the camera for a bare OBJ.
//!
//! ```text
//! z − max.z = max( half width / tan(fov/2), half height / tan(fov_y/2) ) / 0.9      tan(fov_y/2) = tan(fov/2)·h/w
//! ```
//!
//! This distance lets the nearest face of the bounding box, seen along −z, fill 90 % of the frame in its tighter direction.
//! fov and fov_y are the horizontal and vertical fields of view, w and h the width and height in pixels.

use super::cursor::Cursor;
use crate::scene::{SceneError, description::CameraDescription};
use glam::DVec3;

/// Horizontal field of view for a bare OBJ, degrees: that of the Cornell box's camera, with 25 mm of film behind a 35 mm
/// lens.
pub(super) const FRAMED_FOV: f64 = 39.3077;
const FILLED: f64 = 0.9;
/// Smallest allowed width of a pixel at distance 1. Its square enters a density, which is multiplied with others in single
/// precision. Directions in `f64` are exact to a thousandth of this width.
const NARROWEST: f64 = 1e-12;
pub(super) const KEYS: [&str; 5] = ["origin", "target", "up", "fov", "size"];

/// Reads `[camera]`. With `bounds`, a missing origin, target or up is chosen so that the box `bounds` fills the frame.
pub(super) fn read(c: &Cursor, bounds: Option<[DVec3; 2]>) -> Result<CameraDescription, SceneError> {
    c.only(&KEYS)?;
    let at = c.require("fov", "the horizontal field of view in degrees: fov = 40")?;
    let fov = at.number()?;
    if !(fov > 0.0 && fov < 180.0) {
        return Err(at.error(format!("fov {fov} is outside (0, 180)")).help("fov is the horizontal angle in degrees"));
    }
    let size = c.require("size", "width and height in pixels: size = [256, 256]")?.size()?;
    let pixel = 2.0 * (0.5 * fov).to_radians().tan() / f64::from(size[0]);
    if pixel < NARROWEST {
        let e = at.error(format!("fov {fov:e} makes pixels {pixel:.0e} rad wide, too narrow for single precision"));
        return Err(e.help(format!(
            "use at least {:.0e} degrees for {} pixels",
            NARROWEST.to_degrees() * f64::from(size[0]),
            size[0]
        )));
    }
    let framed = bounds.map(|b| frame(b, fov, size));
    let vector = |key: &str, example: &str, default: Option<DVec3>| match (c.get(key), default) {
        (None, Some(v)) => Ok(v),
        _ => c.require(key, example)?.vector(),
    };
    let origin = vector("origin", "the position of the pinhole: origin = [0, 0, 4]", framed.map(|f| f.0))?;
    let target = vector("target", "a point in the centre of the image: target = [0, 0, 0]", framed.map(|f| f.1))?;
    let up = vector("up", "the direction that is up in the image: up = [0, 1, 0]", framed.map(|_| DVec3::Y))?;
    let forward = target - origin;
    let place = |key: &str| c.get(key).unwrap_or(c.clone());
    // a thousand times the rounding of the coordinates
    if forward.length() <= 2e-13 * (origin.length() + target.length()) {
        let e = place("target").error("camera origin and target are the same point");
        return Err(e.help("move the target to a point that the camera should look at"));
    }
    if up == DVec3::ZERO {
        return Err(place("up").error("up has zero length").help("write a direction such as [0, 1, 0]"));
    }
    if up.normalize().cross(forward.normalize()).length() <= 1e-6 {
        let e = place("up").error("up is parallel to the viewing direction");
        return Err(e.help(
            "choose an up that is not parallel to target - origin, such as [0, 0, 1] for a camera looking along y",
        ));
    }
    Ok(CameraDescription { origin, target, up, fov, size })
}

/// Origin and target of the camera that looks along −z at the box.
fn frame([min, max]: [DVec3; 2], fov: f64, [w, h]: [u32; 2]) -> (DVec3, DVec3) {
    let (center, half) = (0.5 * (min + max), 0.5 * (max - min));
    let tan_x = (0.5 * fov).to_radians().tan();
    let tan_y = tan_x * f64::from(h) / f64::from(w);
    let distance = (half.x / tan_x).max(half.y / tan_y) / FILLED;
    (DVec3::new(center.x, center.y, max.z + distance), center)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of the near face project to 0.9 of half the frame in the tighter direction.
    #[test]
    fn framing_fills_ninety_percent() {
        for (half, size) in [((2.0, 1.0), [256, 256]), ((1.0, 2.0), [300, 100]), ((1.0, 2.0), [100, 300])] {
            let (x, y): (f64, f64) = half;
            let (origin, target) = frame([DVec3::new(5.0 - x, -y, 1.0), DVec3::new(5.0 + x, y, 3.0)], 50.0, size);
            let d = origin.z - 3.0;
            let tan = 25f64.to_radians().tan();
            let fill = (x / (d * tan)).max(y / (d * tan * f64::from(size[1]) / f64::from(size[0])));
            assert!((fill - 0.9).abs() < 1e-12, "{fill}");
            assert_eq!((origin.x, origin.y, target), (5.0, 0.0, DVec3::new(5.0, 0.0, 2.0)));
        }
    }
}
