//! The letters of all bitmaps: those that ship with the build, since a machine may have none.

use std::sync::Once;

use plotters::style::{FontStyle, register_font};

/// Makes `sans-serif` known. An SVG names the family and leaves the letters to who shows it.
pub(crate) fn register() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let registered = register_font("sans-serif", FontStyle::Normal, ttf_noto_sans::REGULAR);
        assert!(registered.is_ok(), "the font that ships with the build is a font");
    });
}
