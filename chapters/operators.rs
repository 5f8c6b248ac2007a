//! Identities of operators, checked in numbers on the matrix of a Cornell box. Operators are values that can be added,
//! multiplied and inverted.
//!
//! ```text
//! ⟨W, T x⟩ = ⟨T*W, x⟩        ⟨W, (I − T)⁻¹E⟩ = ⟨(I − T*)⁻¹W, E⟩        ⟨u, v⟩ = Σᵢ Aᵢ uᵢ vᵢ
//! ```
//!
//! T is the operator for red light, S the one for green light, E the emission of the lamp in red, and W the mean over the red
//! wall. Tracing paths from the eye evaluates the left side of the second equation, tracing from the lamp the right side.
//! ⟨(T*)²W, T E⟩ combines both.
//!
//! `cargo run --release --example operators`
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::operator::algebra::{AlgebraError, Expression};
use fredholm::operator::form_factor::{FormFactors, VisibilitySampling};
use fredholm::operator::matrix::LinearOperator;
use fredholm::operator::patches::Patches;
use fredholm::progress::Progress;
use fredholm::scene::{Scene, load};
use fredholm::solver::Radiosity;
use std::{error::Error, process::ExitCode};

/// Two numbers that should be equal, or should differ.
pub struct Equation {
    /// The equation as text.
    pub says: &'static str,
    /// Values of the left and the right side.
    pub sides: [f64; 2],
    /// The reason why the equation does not hold; none if it should hold.
    pub but: Option<&'static str>,
}

impl Equation {
    /// The relative difference |left − right|/|right|.
    pub fn apart(&self) -> f64 {
        let [left, right] = self.sides;
        ((left - right) / right).abs()
    }

    /// Returns true if the result is as expected: the sides of an identity agree up to rounding, all others differ clearly.
    pub fn is_right(&self) -> bool {
        if self.but.is_none() { self.apart() < 1e-13 } else { self.apart() > 1e-3 }
    }
}

/// The matrix of a Cornell box.
///
/// # Errors
/// If the scene cannot be loaded or meshed, which is a defect of the program.
pub fn room() -> Result<Radiosity, Box<dyn Error>> {
    let room = load::scene("cornell", &load::Options::default())?.description;
    let patches = Patches::new(&room, 600)?;
    let factors = FormFactors::new(&patches, &Scene::new(&room), VisibilitySampling::default(), Progress::NONE)?;
    Ok(Radiosity::new(patches, factors))
}

/// All equations that are printed.
///
/// # Errors
/// If operators do not fit together, which is a defect of the program.
pub fn equations(room: &Radiosity) -> Result<Vec<Equation>, AlgebraError> {
    let (red, green) = (room.operator(0), room.operator(1));
    let (t, s) = (Expression::from(&red), Expression::from(&green));
    let e = room.emission(0);
    // W, the mean over the wall that reflects only red light: ⟨W, x⟩ = Σ Aᵢ xᵢ/A over its patches
    let wall: Vec<bool> = room.patches.iter().map(|p| p.reflectance.x > 5.0 * p.reflectance.y).collect();
    let area: f64 = wall.iter().zip(t.area()).filter(|p| *p.0).map(|p| p.1).sum();
    let w: Vec<f64> = wall.iter().map(|on| if *on { 1.0 / area } else { 0.0 }).collect();

    let identity = Expression::identity(t.area());
    let (adjoint, light) = (t.adjoint(), t.resolvent()?);
    let seen = |x: &Expression<'_>| Ok::<f64, AlgebraError>(t.inner(&w, &x.of(&e)?));
    let met = |a: &Expression<'_>, b: &Expression<'_>| Ok::<f64, AlgebraError>(t.inner(&a.of(&w)?, &b.of(&e)?));
    let sum = s.plus(&t)?;
    let product = s.times(&t)?;
    let squares = s.power(2).plus(&t.power(2))?.plus(&product)?.plus(&t.times(&s)?)?;
    let first = (1..4).try_fold(identity.clone(), |sum, k| sum.plus(&t.power(k)))?;
    let equation = |says, left: f64, right: f64| Equation { says, sides: [left, right], but: None };
    Ok(vec![
        equation("⟨W, T E⟩ = ⟨T*W, E⟩", seen(&t)?, met(&adjoint, &identity)?),
        equation("⟨W, T³E⟩ = ⟨(T*)²W, T E⟩", seen(&t.power(3))?, met(&adjoint.power(2), &t)?),
        equation("⟨W, (I − T)⁻¹E⟩ = ⟨(I − T*)⁻¹W, E⟩", seen(&light)?, met(&adjoint.resolvent()?, &identity)?),
        equation("⟨W, S T E⟩ = ⟨T*S*W, E⟩", seen(&product)?, met(&adjoint.times(&s.adjoint())?, &identity)?),
        equation("(S + T)² = S² + S T + T S + T²", seen(&sum.power(2))?, seen(&squares)?),
        equation("(I − T)⁻¹ = I + T + T² + T³ + T⁴(I − T)⁻¹", seen(&light)?, {
            seen(&first.plus(&t.power(4).times(&light)?)?)?
        }),
        equation("T (I − T)⁻¹ = (I − T)⁻¹ − I", seen(&t.times(&light)?)?, seen(&light.minus(&identity)?)?),
        Equation {
            says: "⟨W, T E⟩ = ⟨T W, E⟩", sides: [seen(&t)?, met(&t, &identity)?], but: Some("no: T is not T*")
        },
        Equation {
            says: "S T = T S",
            sides: [seen(&product)?, seen(&t.times(&s)?)?],
            but: Some("no: they do not commute"),
        },
    ])
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let room = room()?;
    let equations = equations(&room)?;
    println!("{} patches; T: red, S: green, E: the lamp, W: the mean over the red wall\n", room.factors.n);
    for e in &equations {
        let [left, right] = e.sides;
        println!("{:<42} {left:.15}  {right:.15}  {:.1e}  {}", e.says, e.apart(), e.but.unwrap_or_default());
    }
    Ok(if equations.iter().all(Equation::is_right) { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
