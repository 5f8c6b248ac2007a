//! Fresnel's equations: the fraction of unpolarised light that a smooth interface reflects.
//!
//! ```text
//! dielectric   R_s = ((c − g)/(c + g))²        R_p = ((η²c − g)/(η²c + g))²        g² = η² − 1 + c²
//! conductor    R_s = ((a − c)² + b²)/((a + c)² + b²)        R_p = R_s ((ac − s²)² + b²c²)/((ac + s²)² + b²c²)
//! hemisphere   F_out = 2 ∫₀¹ R(c) c dc        1 − F_in = (1 − F_out)/η²
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | η | index on the far side divided by the index on the side of the light | [`Interface::eta`] |
//! | c, s | cosine and sine of the angle of incidence | arguments |
//! | g/η | cosine of the angle of refraction; g² ≤ 0 is total internal reflection | [`Interface::refracted`] |
//! | R | reflectance ½ (R_s + R_p) | [`Interface::reflectance`], [`conductor`] |
//! | η + ik | complex index of a metal | [`conductor`] |
//! | a + ib | √((η + ik)² − s²): η + ik times the cosine of the angle inside the metal | [`conductor`] |
//! | F_out, F_in | R averaged over cosine-weighted directions, for light from outside and from inside | [`hemispherical`] |
//!
//! The differences c − g and η²c − g lose all their digits when little is reflected. Written with e = η² − 1 they are
//! −e/(c + g) and e((η² + 1)c² − 1)/(η²c + g), which lose none. a² = ½(√(t² + 4η²k²) + t) with t = η² − k² − s² has the same
//! problem for t < 0, so it is then computed as η²k²/b².
//!
//! References: Born and Wolf, *Principles of Optics* (7th ed. 1999), sections 1.5 and 14.2; Walsh, *The reflection factor
//! of a polished glass surface for diffused light* (Dept. of Scientific and Industrial Research, Illumination Research
//! Technical Paper 2, 1926), whose integral Duntley checked in *The optical properties of diffusing materials* (JOSA 32,
//! 1942).

use crate::math::Rgb;

/// A smooth boundary between two dielectrics, seen from one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// η: index beyond the surface divided by the index on this side.
    pub eta: f32,
    eta2: f32,
    // η² − 1, computed in f64 and rounded only after the subtraction
    e: f32,
}

impl Interface {
    /// The boundary to a medium of index `beyond`, seen from the side of index `here`.
    pub fn new(here: f64, beyond: f64) -> Self {
        let eta = beyond / here;
        Self { eta: eta as f32, eta2: (eta * eta) as f32, e: ((eta - 1.0) * (eta + 1.0)) as f32 }
    }

    /// η².
    #[inline(always)]
    pub fn eta2(&self) -> f32 {
        self.eta2
    }

    /// g: η times the cosine of the angle of refraction. `None` under total internal reflection.
    #[inline(always)]
    pub fn refracted(&self, c: f32) -> Option<f32> {
        let g2 = self.e + c * c;
        if g2 > 0.0 { Some(g2.sqrt()) } else { None }
    }

    /// R: reflectance for incidence at cosine c > 0; 1 under total internal reflection.
    #[inline(always)]
    pub fn reflectance(&self, c: f32) -> f32 {
        match self.refracted(c) {
            Some(g) => self.between(c, g),
            None => 1.0,
        }
    }

    /// R from both cosines c and g/η. Needed when g is known more exactly than c gives it: near the critical angle, g²
    /// computed from c has lost its digits.
    #[inline(always)]
    pub fn between(&self, c: f32, g: f32) -> f32 {
        let (s, p) = (c + g, self.eta2 * c + g);
        let (s, p) = (self.e / (s * s), self.e * ((self.eta2 + 1.0) * (c * c) - 1.0) / (p * p));
        0.5 * (s * s + p * p)
    }
}

/// R: reflectance per channel of a metal with index η + ik, for incidence at cosine c.
#[inline(always)]
pub fn conductor(c: f32, eta: Rgb, k: Rgb) -> Rgb {
    let (c2, s2) = (c * c, 1.0 - c * c);
    let (eta2, k2) = (eta * eta, k * k);
    let product = eta2 * k2;
    let t = eta2 - k2 - Rgb::splat(s2);
    let larger = 0.5 * ((t * t + 4.0 * product).map(f32::sqrt) + t.abs());
    let smaller = product / larger;
    let positive = t.cmpge(Rgb::ZERO);
    let (a2, b2) = (Rgb::select(positive, larger, smaller), Rgb::select(positive, smaller, larger));
    let a = a2.map(f32::sqrt);
    let square = |x: Rgb| x * x;
    let s = (square(a - c) + b2) / (square(a + c) + b2);
    let p = (square(a * c - s2) + b2 * c2) / (square(a * c + s2) + b2 * c2);
    0.5 * s * (1.0 + p)
}

/// F_out of a boundary to relative index η: R averaged over the cosine-weighted hemisphere, in closed form (Walsh).
pub fn hemispherical(eta: f64) -> f64 {
    if eta < 1.0 {
        // this is F_in of the reciprocal index
        return 1.0 - (1.0 - hemispherical(1.0 / eta)) * eta * eta;
    }
    let d = eta - 1.0;
    if d < 1e-6 {
        // the first term of the series, because the closed form loses its digits here
        return d / 3.0;
    }
    let n2 = eta * eta;
    let n4 = n2 * n2;
    let (plus, minus) = (n2 + 1.0, d * (eta + 1.0));
    let quartic = plus * minus; // n⁴ − 1
    0.5 + d * (3.0 * eta + 1.0) / (6.0 * (eta + 1.0) * (eta + 1.0))
        + n2 * minus * minus / (plus * plus * plus) * (d / (eta + 1.0)).ln()
        - 2.0 * n2 * eta * (n2 + 2.0 * eta - 1.0) / (plus * quartic)
        + 8.0 * n4 * (n4 + 1.0) / (plus * quartic * quartic) * d.ln_1p()
}
