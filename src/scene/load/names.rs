//! Names that a scene gives: of itself, its materials and its shapes. They appear in folders, pictures, pages and on terminals.
//!
//! | not allowed | because |
//! |---|---|
//! | more than 200 bytes | a file name may have 255 bytes, and folders add to the name of the scene |
//! | control characters | a terminal obeys some of them |
//! | characters that change the direction of writing | a name then looks like another one |

use crate::math::names::{hides, turns, visible};

/// Longest name in bytes.
const LONGEST: usize = 200;

/// Why a name cannot be used, and what to do.
pub(super) struct Fault {
    pub(super) what: String,
    pub(super) help: &'static str,
}

/// Returns an error if `name`, the name of a `what`, contains characters that hide something.
pub(super) fn check(name: &str, what: &str) -> Result<(), Fault> {
    let Some(c) = name.chars().find(|&c| hides(c)) else { return Ok(()) };
    let kind = if turns(c) { "changes the direction of writing" } else { "is a control character" };
    let what = format!("the {what} name `{}` contains {}, which {kind}", visible(name), c.escape_unicode());
    Err(Fault { what, help: "use letters, digits, spaces, - and _" })
}

/// The same for the name of a scene, which is also the name of a folder.
pub(super) fn check_scene(name: &str) -> Result<(), Fault> {
    if name.len() > LONGEST {
        let what = format!("the scene name has {} bytes; {LONGEST} are possible", name.len());
        return Err(Fault { what, help: "choose a shorter name: name = \"…\"" });
    }
    check(name, "scene")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_hide_something_are_refused() {
        for name in ["red\u{1b}[31m", "a\nb", "a\u{7f}", "\u{9b}2J", "gnp.\u{202e}x", "\u{2066}a"] {
            let said = check(name, "material").err().map(|fault| fault.what).unwrap_or_default();
            assert!(said.contains("name"), "{name:?}");
            assert!(!said.chars().any(|c| c.is_control() || turns(c)), "{said:?}");
        }
        for name in ["red", "Wände 2", "белый", "a_b-c.1", "日本"] {
            assert!(check(name, "material").is_ok(), "{name}");
        }
        assert!(check_scene(&"é".repeat(100)).is_ok() && check_scene(&"é".repeat(101)).is_err());
    }
}
