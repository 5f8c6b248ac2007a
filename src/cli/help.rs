//! Layout of the help: options in groups, the scene first, `-h` on one screen and `--help` with everything.

use super::options::OUTPUT;
use clap::{Arg, ArgAction, Command};

/// Above `fredholm --help`.
pub const ABOUT: &str = "The operator view of global illumination: L = E + T L = Σ T^k E, measured

Without arguments: the tour. A Cornell box is solved in three ways (each bounce by its own estimator, the full path tracer, the \
radiosity matrix). The answers are compared with error bars and written to fredholm-out/cornell with pictures, plots and a report.";

/// Below `fredholm -h`.
pub const SHORT: &str = "Without arguments: the tour of a Cornell box, in less than a minute.
Options of a command: fredholm COMMAND -h. Examples: fredholm --help";

/// Below `fredholm --help`.
pub const EXAMPLES: &str = "Examples:
  fredholm                                   the tour
  fredholm series cornell --spp 64           each bounce, and their sum
  fredholm series box.toml --set materials.white.reflectance=[0.6,0.6,0.6]
  fredholm compare fredholm-out/cornell b    a verdict per term
  fredholm sweep cornell --over technique    one setting, several values
  fredholm roulette cornell --optimise       how paths should end
  fredholm info                              the built-in scenes
  fredholm info cornell                      materials, lights, bounds

Options of a command: fredholm COMMAND -h for the usual ones, fredholm COMMAND --help for all.

Exit codes: 0 ok, 1 a comparison failed, 2 wrong usage, 3 something is wrong with a scene or a file, 130 interrupted; \
143 and 129 ended by SIGTERM and SIGHUP (results so far are saved).";

/// The command with its help laid out. `brief` is true for `-h`, which names the values of an option in the text only.
pub fn arranged(command: Command, brief: bool) -> Command {
    command.mut_subcommands(|s| {
        let path = format!("fredholm {}", s.get_name());
        arrange(s, &path, brief)
    })
}

fn arrange(command: Command, path: &str, brief: bool) -> Command {
    let command = command.mut_subcommands(|s| {
        let path = format!("{path} {}", s.get_name());
        arrange(s, &path, brief)
    });
    // clap lists what has no position last, and a scene has none
    let command = command.mut_args(|a| {
        let order = if a.is_positional() { 0 } else { a.get_display_order() + 1 };
        // a switch takes no value, so it has none to hide
        let hidden = a.is_hide_possible_values_set() || brief && a.get_action().takes_values();
        a.display_order(order).hide_possible_values(hidden)
    });
    let help = Arg::new("help").short('h').long("help").action(ArgAction::Help).display_order(usize::MAX);
    let help = help.help("Print help: -h the usual options, --help all");
    let grouped = command.get_arguments().any(|a| a.get_help_heading().is_some());
    let help = if grouped { help.help_heading(OUTPUT) } else { help };
    let more = format!("All options and examples: {path} --help");
    command.disable_help_flag(true).arg(help).after_help(more)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scene_comes_first_under_its_heading() {
        let option = Arg::new("set").long("set").help_heading("What");
        let scene = Arg::new("scene").help_heading("What");
        let command = Command::new("fredholm").subcommand(Command::new("info").arg(option).arg(scene));
        let text = arranged(command, true).find_subcommand_mut("info").map(|c| c.render_help().to_string());
        let text = text.unwrap_or_default();
        let at = |what| text.find(what).unwrap_or(usize::MAX);
        assert!(at("  [scene]") < at("--set") && at("--set") < at("-h, --help"), "{text}");
        assert!(text.ends_with("All options and examples: fredholm info --help\n"), "{text}");
    }
}
