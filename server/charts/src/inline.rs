//! Puts style, scripts and data into the page that shows the charts. The build script of the server, which embeds that page, has a copy of this file.

/// Sources of the page, in the order of the scripts.
pub(crate) struct Sources<'a> {
    pub(crate) page: &'a str,
    pub(crate) style: &'a str,
    pub(crate) scripts: &'a [&'a str],
}

impl Sources<'_> {
    /// The page with everything in it. In the data `<` is written as an escape of JSON, so that no text ends the element.
    pub(crate) fn with_data(&self, json: &str) -> String {
        let page = self.page.replacen("/*STYLE*/", self.style, 1).replacen("/*SCRIPT*/", &self.scripts.concat(), 1);
        page.replacen("/*DATA*/", &json.replace('<', "\\u003c"), 1)
    }
}
