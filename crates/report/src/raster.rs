//! Drawings as pixels and as pages, the same on every machine: text is set in a font that comes with the library.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Options, Tree, WriteOptions};

/// The largest side of a picture [px].
const LARGEST: f32 = 16_384.0;

/// Why a drawing was not made into a picture.
#[derive(Debug, thiserror::Error)]
#[error("the drawing can not be made into a picture: {0}")]
pub struct RasterError(String);

/// The fonts of drawings: DejaVu Sans Condensed alone, whatever the system has.
static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    for font in [dejavu::sans_condensed::regular(), dejavu::sans_condensed::bold()] {
        fonts.load_font_data(font.to_vec());
    }
    let family = fonts.faces().next().and_then(|face| face.families.first().map(|family| family.0.clone()));
    fonts.set_sans_serif_family(family.unwrap_or_default());
    Arc::new(fonts)
});

fn tree(svg: &str) -> Result<Tree, RasterError> {
    let options = Options { fontdb: FONTS.clone(), ..Options::default() };
    Tree::from_str(svg, &options).map_err(|e| RasterError(e.to_string()))
}

/// Returns an SVG document as a PNG file, `scale` pixels for each of its own.
///
/// # Errors
/// The text is not an SVG document, or the picture would have no side or one of more than 16384 pixels.
pub fn to_png(svg: &str, scale: f32) -> Result<Vec<u8>, RasterError> {
    let tree = tree(svg)?;
    let size = [tree.size().width() * scale, tree.size().height() * scale].map(f32::ceil);
    let [width, height] = size;
    let pixels = size.iter().all(|side| (1.0..=LARGEST).contains(side));
    let pixels = pixels.then(|| Pixmap::new(width as u32, height as u32)).flatten();
    let mut pixels = pixels.ok_or_else(|| RasterError(format!("{width} x {height} pixels are not drawn")))?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| RasterError(e.to_string()))
}

/// Returns an SVG document as a PDF file of one page. Its letters are outlines, which look the same everywhere; a program
/// can not search for them.
///
/// # Errors
/// The text is not an SVG document, or it can not be written as PDF.
pub fn to_pdf(svg: &str) -> Result<Vec<u8>, RasterError> {
    // The writer of pages would need two more libraries to put a font into its files.
    let outlines = tree(svg)?.to_string(&WriteOptions { preserve_text: false, ..WriteOptions::default() });
    let tree = Tree::from_str(&outlines, &Options::default()).map_err(|e| RasterError(e.to_string()))?;
    svg2pdf::to_pdf(&tree, svg2pdf::ConversionOptions::default(), svg2pdf::PageOptions::default())
        .map_err(|e| RasterError(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Axis, Figure, Mark, Scale};

    fn drawing() -> String {
        let figure = Figure {
            name: "a".to_owned(),
            title: "\u{3c3} and \u{221a}".to_owned(),
            x: Axis::new("t [s]", "t", Scale::Linear, (0.0, 1.0)),
            y: Axis::new("error", "error", Scale::Logarithmic, (1e-9, 1.0)),
            is_isometric: false,
            caption: "h = 0.4".to_owned(),
            size: Some((400.0, 300.0)),
            parameter: None,
            marks: vec![Mark::Guide { points: vec![(0.0, 1e-9), (1.0, 1.0)] }],
        };
        figure.to_svg()
    }

    #[test]
    fn a_picture_has_the_size_that_was_asked_for_and_the_same_bytes_again() {
        let svg = drawing();
        let picture = to_png(&svg, 2.0).unwrap();
        assert!(picture.starts_with(b"\x89PNG\r\n\x1a\n"));
        let side = |at: usize| u32::from_be_bytes(picture[at..at + 4].try_into().unwrap());
        assert_eq!((side(16), side(20)), (800, 600));
        assert_eq!(picture, to_png(&svg, 2.0).unwrap());
    }

    #[test]
    fn text_shows() {
        let svg = drawing();
        let bare: String =
            svg.split("<text").map(|part| part.split_once("</text>").map_or(part, |p| p.1)).collect();
        assert_ne!(to_png(&svg, 1.0).unwrap(), to_png(&bare, 1.0).unwrap());
    }

    #[test]
    fn a_page_is_a_whole_pdf_file() {
        let page = to_pdf(&drawing()).unwrap();
        assert!(page.starts_with(b"%PDF-"));
        assert!(String::from_utf8_lossy(&page[page.len() - 16..]).contains("%%EOF"));
        assert_eq!(page, to_pdf(&drawing()).unwrap());
    }

    #[test]
    fn what_can_not_be_drawn_is_refused_with_a_reason() {
        assert!(to_png("no picture", 1.0).is_err());
        assert!(to_png(&drawing(), 1e6).unwrap_err().to_string().contains("pixels are not drawn"));
        assert!(to_png(&drawing(), f32::NAN).is_err());
    }
}
