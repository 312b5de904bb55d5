//! The page that the reader takes along: the picture with its spectra, in one HTML file.

/// The colours of all pages, in light and in dark surroundings.
pub(crate) const COLOURS: &str = include_str!("colours.css");

/// Returns the text of the page without data. The page of the view fills the element `data`. The
/// page has the plots of the view, and its policy forbids all requests.
pub(crate) fn template() -> String {
    [
        include_str!("export_head.html"),
        COLOURS,
        include_str!("export.css"),
        include_str!("export_body.html"),
        include_str!("plots.js"),
        include_str!("export_viewer.js"),
        "</script></body></html>\n",
    ]
    .concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exported_page_asks_for_nothing() {
        let page = template();
        assert!(page.contains("default-src 'none'") && page.matches(r#"id="data"></script>"#).count() == 1);
        assert!(
            !["src=", "href=", "@import", "url(", "http:", "https:", "fetch("].iter().any(|word| page.contains(word))
        );
    }
}
