//! The page template of mdBook, changed where it cannot be used by keys or is invalid for screen readers.

use std::path::Path;
use std::{fs, io};

use super::links::pages;

/// The button of the table of contents: mdBook has a label, which no key reaches; `docs/book.js` toggles the checkbox that it named.
const TOGGLE: [&str; 2] = [
    r#"<label id="mdbook-sidebar-toggle" class="icon-button" for="mdbook-sidebar-toggle-anchor""#,
    r#"<button id="mdbook-sidebar-toggle" class="icon-button" type="button""#,
];

/// The bar above each page, which mdBook leaves without a landmark.
const BAR: [&str; 2] = [
    r#"<div id="mdbook-menu-bar" class="menu-bar sticky">"#,
    r#"<div id="mdbook-menu-bar" class="menu-bar sticky" role="banner">"#,
];

/// Changes all pages of the book.
///
/// # Errors
/// If a page cannot be read or written, or does not have the expected template.
pub(super) fn change(book: &Path) -> io::Result<()> {
    for (path, page) in pages(book)? {
        // The table of contents for browsers without scripts is a page in a frame.
        if path.ends_with("toc.html") {
            continue;
        }
        let page = changed(&page).ok_or_else(|| {
            let message = format!("{}: not the page template of this mdBook", path.display());
            io::Error::other(message)
        })?;
        fs::write(path, page)?;
    }
    Ok(())
}

/// A page with the changes; none if it has another template.
fn changed(page: &str) -> Option<String> {
    let (before, rest) = page.split_once(TOGGLE[0])?;
    let (button, after) = rest.split_once("</label>")?;
    let page = format!("{before}{}{button}</button>{after}", TOGGLE[1]);
    page.contains(BAR[0]).then(|| page.replace(BAR[0], BAR[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_contents_has_a_button_and_the_bar_a_landmark() {
        let page = format!("{} {} title=\"T\">=</label><label>a</label></div>", BAR[0], TOGGLE[0]);
        let expect =
            format!("{} {} title=\"T\">=</button><label>a</label></div>", BAR[1], TOGGLE[1]);
        assert_eq!(changed(&page), Some(expect));
        assert_eq!(changed("<label>a</label>"), None, "another template");
        assert_eq!(changed(&page.replace(BAR[0], "<div>")), None, "no bar");
    }
}
