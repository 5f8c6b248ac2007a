//! `index.html` of a set of figures: for each its topic, the picture, a caption to read aloud, and the command that makes it.
//!
//! The pictures are files beside the page, so that each can be put on a slide. The page needs no network and no script.

use crate::report::{ReportError, image::typeset::escape, write_atomically};
use std::fmt::Write;
use std::path::Path;

/// A figure of the set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exhibit {
    /// Name of the figure; the anchor of its section.
    pub id: String,
    /// Heading.
    pub topic: String,
    /// What to look at.
    pub caption: String,
    /// The picture, relative to the page.
    pub picture: String,
    /// The command that makes it.
    pub command: String,
}

/// Writes the page.
///
/// # Errors
/// If the file cannot be written.
pub fn write(path: &Path, title: &str, sentence: &str, exhibits: &[Exhibit]) -> Result<(), ReportError> {
    write_atomically(path, page(title, sentence, exhibits).as_bytes())
}

fn page(title: &str, sentence: &str, exhibits: &[Exhibit]) -> String {
    const STYLE: &str = include_str!("page.css");
    let [title, sentence] = [title, sentence].map(escape);
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n<p class=\"answer\">{sentence}</p>\n<ol>\n"
    );
    // writing to a string cannot fail
    for Exhibit { id, topic, .. } in exhibits {
        let _ = writeln!(html, "<li><a href=\"#{}\">{}</a></li>", escape(id), escape(topic));
    }
    html += "</ol>\n";
    for Exhibit { id, topic, caption, picture, command } in exhibits {
        let [id, topic, caption, picture, command] = [id, topic, caption, picture, command].map(|s| escape(s));
        let _ = write!(
            html,
            "<section id=\"{id}\">\n<h2>{topic}</h2>\n<figure><a href=\"{picture}\"><img src=\"{picture}\" \
             alt=\"{caption}\" loading=\"lazy\"></a></figure>\n<p>{caption}</p>\n<pre>{command}</pre>\n</section>\n"
        );
    }
    html + "</body>\n</html>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_has_a_heading_a_picture_a_caption_and_a_command() {
        let one = Exhibit {
            id: "a".into(),
            topic: "A & B".into(),
            caption: "what <to> see".into(),
            picture: "a/a.png".into(),
            command: "fredholm figure a".into(),
        };
        let html = page("slides", "one figure", &[one]);
        for part in
            ["href=\"#a\"", "id=\"a\"", "A &amp; B", "what &lt;to&gt; see", "src=\"a/a.png\"", "fredholm figure a"]
        {
            assert!(html.contains(part), "{part} is missing in {html}");
        }
        assert!(!html.contains("http"), "the page asks the network");
    }
}
