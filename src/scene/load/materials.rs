//! `[materials.NAME]`: how a surface scatters, within what conserves energy.
//!
//! | symbol | meaning | legal |
//! |---|---|---|
//! | ρ | `reflectance`, or each texel of `texture` | [0, 1] |
//! | ρ + s | with `specular`, per channel | at most 1 |
//! | η | `ior`, `ior_outside` | [1, 10] |
//! | η + ik | `eta`, `k` of a metal | (0, 100], [0, 100] |
//! | α | `alpha`, width of GGX (Walter, Marschner, Li and Torrance 2007), not squared | [0.001, 1] |

use super::{beside, cursor::Cursor, image};
use crate::scene::{
    SceneError,
    description::{BsdfDescription, Choice, Colour, Ggx, Masking, Material, Metal, Sides},
};
use glam::DVec3;
use std::sync::Arc;

/// The kinds of material with their keys; `sides` is legal on all, if only to be refused on glass with a reason.
pub(super) const KINDS: [(&str, &[&str]); 6] = [
    ("diffuse", &["type", "reflectance", "texture", "sides"]),
    ("mirror", &["type", "reflectance", "sides"]),
    ("conductor", &["type", "eta", "k", "reflectance", "alpha", "masking", "sides"]),
    ("dielectric", &["type", "ior", "ior_outside", "choice", "alpha", "masking", "sides"]),
    ("plastic", &["type", "reflectance", "texture", "ior", "alpha", "masking", "sides"]),
    ("phong", &["type", "reflectance", "texture", "specular", "exponent", "sides"]),
];

/// Widths below are smooth to `f32`.
const NARROWEST: f64 = 0.001;
/// Indices of refraction from vacuum to beyond every solid.
pub(super) const IOR: [f64; 2] = [1.0, 10.0];
/// Lobes narrower than this exponent are mirrors to `f32`.
pub(super) const LARGEST_EXPONENT: f64 = 1e6;
/// Sums of decimal fractions are above 1 by rounding at most this much.
pub(super) const ROUNDING: f64 = 1e-9;
const REFLECTANCE: &str = "reflectance = [r, g, b] with values in [0, 1]";

/// Reads one material.
pub(super) fn read(name: &str, c: &Cursor) -> Result<Material, SceneError> {
    let at = c.require("type", "type = \"diffuse\"; types: diffuse, mirror, conductor, dielectric, plastic, phong")?;
    let kinds: Vec<(&str, (&str, &[&str]))> = KINDS.iter().map(|&(k, keys)| (k, (k, keys))).collect();
    let (kind, keys) = at.choice("type of material", &kinds)?;
    c.only(keys)?;
    let sides = match c.get("sides") {
        Some(s) if kind == "dielectric" => {
            return Err(s.error("a dielectric has no sides").help("light passes from both sides: remove the key"));
        }
        Some(s) => s.choice("choice of sides", &[("both", Sides::Both), ("front", Sides::Front)])?,
        None => Sides::Both,
    };
    let bsdf = match kind {
        "diffuse" => BsdfDescription::Diffuse { reflectance: colour(c)? },
        "mirror" => BsdfDescription::Mirror { reflectance: c.require("reflectance", REFLECTANCE)?.reflectance()? },
        "conductor" => BsdfDescription::Conductor { metal: metal(c)?, rough: rough(c)? },
        "dielectric" => dielectric(c)?,
        "plastic" => {
            let ior = c.get("ior").map_or(Ok(1.5), |i| i.within("ior", IOR[0], IOR[1]))?;
            BsdfDescription::Plastic { reflectance: colour(c)?, ior, rough: rough(c)? }
        }
        _ => phong(c)?,
    };
    Ok(Material { name: name.to_owned(), bsdf, sides })
}

/// The image of a material that has one.
pub(super) fn texture_of(material: &Material) -> bool {
    match &material.bsdf {
        BsdfDescription::Diffuse { reflectance: r }
        | BsdfDescription::Plastic { reflectance: r, .. }
        | BsdfDescription::Phong { reflectance: r, .. } => matches!(r, Colour::Texture(_)),
        _ => false,
    }
}

/// The largest albedo of each channel.
pub(super) fn largest(colour: &Colour) -> DVec3 {
    match colour {
        Colour::Uniform(rho) => *rho,
        Colour::Texture(t) => image::largest(t).as_dvec3(),
    }
}

/// An image of albedos, none above 1. Whoever named the file adds the place to the error.
pub(super) fn albedos(path: &std::path::Path) -> Result<crate::scene::raster::Raster, SceneError> {
    let raster = image::read(path)?;
    match raster.texels.iter().position(|t| t.max_element() > 1.0) {
        Some(i) => {
            let (texel, value) = (image::texel(&raster, i), raster.texels[i].max_element());
            let what = format!("{texel} of `{}` reflects {value}, more than it receives", path.display());
            Err(SceneError::new(what).help("the texels of a texture are albedos in [0, 1]"))
        }
        None => Ok(raster),
    }
}

/// `reflectance` or `texture`.
fn colour(c: &Cursor) -> Result<Colour, SceneError> {
    match (c.get("reflectance"), c.get("texture")) {
        (Some(_), Some(t)) => Err(t.error("reflectance and texture are both given").help("keep one of them")),
        (None, Some(t)) => {
            let raster = albedos(&beside(t.file, t.text()?)).map_err(|e| t.place(e))?;
            Ok(Colour::Texture(Arc::new(raster)))
        }
        _ => {
            let example = "reflectance = [r, g, b] with values in [0, 1], or texture = \"file.png\"";
            c.require("reflectance", example)?.reflectance().map(Colour::Uniform)
        }
    }
}

fn metal(c: &Cursor) -> Result<Metal, SceneError> {
    match (c.get("eta").or(c.get("k")), c.get("reflectance")) {
        (Some(_), Some(r)) => {
            let e = r.error("eta, k and reflectance are both given");
            Err(e.help("eta and k give the Fresnel reflectance; reflectance alone is the same at every angle"))
        }
        (None, Some(r)) => r.reflectance().map(Metal::Reflectance),
        _ => {
            let eta = c.require("eta", "eta = [r, g, b] and k = [r, g, b], or reflectance = [r, g, b] alone")?;
            let k = c.require("k", "k = [r, g, b], the imaginary part of the index")?;
            Ok(Metal::Fresnel { eta: eta.index("eta", 1e-3)?, k: k.index("k", 0.0)? })
        }
    }
}

/// Microfacets, if there is a width.
fn rough(c: &Cursor) -> Result<Option<Ggx>, SceneError> {
    let Some(at) = c.get("alpha") else {
        return match c.get("masking") {
            Some(m) => Err(m.error("masking without alpha").help("a smooth surface masks nothing: add alpha")),
            None => Ok(None),
        };
    };
    let alpha = at.number()?;
    if alpha < NARROWEST {
        let e = at.error(format!("alpha {alpha} is below {NARROWEST}"));
        return Err(e.help("leave alpha out for a smooth surface"));
    }
    if alpha > 1.0 {
        return Err(at.error(format!("alpha {alpha} is above 1")).help("1 is as rough as GGX gets here"));
    }
    let words = [("height-correlated", Masking::HeightCorrelated), ("separable", Masking::Separable)];
    let masking = c.get("masking").map_or(Ok(Masking::HeightCorrelated), |m| m.choice("kind of masking", &words))?;
    Ok(Some(Ggx { alpha, masking }))
}

fn dielectric(c: &Cursor) -> Result<BsdfDescription, SceneError> {
    let ior = c.require("ior", "the index of refraction inside: ior = 1.5")?.within("ior", IOR[0], IOR[1])?;
    let ior_outside = c.get("ior_outside").map_or(Ok(1.0), |i| i.within("ior_outside", IOR[0], IOR[1]))?;
    let choice = match c.get("choice") {
        None => Choice::Fresnel,
        Some(at) if at.is_text() => at.choice("choice of reflection", &[("fresnel", Choice::Fresnel)])?,
        Some(at) => {
            let p = at.number()?;
            if !(p > 0.0 && p < 1.0) {
                let e = at.error(format!("choice {p} is outside (0, 1)"));
                return Err(e.help("it is the probability of reflection; neither way may be impossible"));
            }
            Choice::Constant(p)
        }
    };
    let rough = rough(c)?;
    if let (Some(_), Some(at)) = (rough, c.get("alpha").filter(|_| (ior / ior_outside - 1.0).abs() < 1e-3)) {
        let e = at.error(format!("alpha between indices {ior_outside} and {ior}, which hardly differ"));
        return Err(e.help("without a step of the index nothing scatters: leave alpha out, or move them 0.1 % apart"));
    }
    Ok(BsdfDescription::Dielectric { ior, ior_outside, choice, rough })
}

fn phong(c: &Cursor) -> Result<BsdfDescription, SceneError> {
    let reflectance = colour(c)?;
    let at = c.require("specular", "the albedo of the lobe: specular = [0.3, 0.3, 0.3]")?;
    let specular = at.albedo("specular")?;
    let example = "how narrow the lobe is: exponent = 50";
    let exponent = c.require("exponent", example)?.within("exponent", 0.0, LARGEST_EXPONENT)?;
    let most = largest(&reflectance);
    if let Some(i) = (0..3).find(|&i| most[i] + specular[i] > 1.0 + ROUNDING) {
        let e = at.error(format!("reflectance {} and specular {} exceed 1 together", most[i], specular[i]));
        return Err(e.help("a surface returns at most what it receives: lower one of them"));
    }
    Ok(BsdfDescription::Phong { reflectance, specular, exponent })
}
