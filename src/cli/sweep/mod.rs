//! `fredholm sweep [SCENE] --over SETTING`: one setting, several values.

mod args;
mod budget;
mod case;
mod patches;
mod reference;
mod split;
mod spp;
mod values;

use super::base::{Ending, Failure};
use args::Over;
pub use args::{HELP, Sweep};

/// Sweeps over what was asked for.
pub fn run(args: &Sweep) -> Result<Ending, Failure> {
    if args.over == Over::Patches {
        return patches::run(args);
    }
    args.refuse_what_has_no_part()?;
    match args.over {
        Over::Spp => spp::run(args),
        Over::Split => split::run(args),
        _ => values::run(args),
    }
}
