//! A backend for plotters that draws into an [`Image`] with the embedded font, so that a PNG needs no font and no library
//! of the system. Only pixels and text are drawn here; plotters composes lines and shapes of pixels.

use crease::internal::report::render::{Image, font};
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontTransform, rasterizer,
};
use std::convert::Infallible;

/// Backend that draws into an image.
pub(super) struct Canvas<'a>(pub(super) &'a mut Image);

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        (self.0.width as u32, self.0.height as u32)
    }

    fn ensure_prepared(&mut self) -> Result<(), DrawingErrorKind<Infallible>> {
        Ok(())
    }

    fn present(&mut self) -> Result<(), DrawingErrorKind<Infallible>> {
        Ok(())
    }

    fn draw_pixel(
        &mut self,
        (x, y): BackendCoord,
        colour: BackendColor,
    ) -> Result<(), DrawingErrorKind<Infallible>> {
        if let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) {
            let (r, g, b) = colour.rgb;
            let under = self.0.pixel(x, y);
            let mix = |over: u8, k: usize| {
                (f64::from(under[k]) * (1.0 - colour.alpha) + f64::from(over) * colour.alpha).round()
            };
            self.0.set(x, y, [mix(r, 0) as u8, mix(g, 1) as u8, mix(b, 2) as u8]);
        }
        Ok(())
    }

    /// Draws segment by segment: as one polygon, a path that overlaps itself would cancel out.
    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Result<(), DrawingErrorKind<Infallible>> {
        let points: Vec<BackendCoord> = path.into_iter().collect();
        for ends in points.windows(2).filter(|ends| ends[0] != ends[1]) {
            if style.stroke_width() > 1 {
                let outline = rasterizer::polygonize(ends, style.stroke_width());
                self.fill_polygon(outline, &style.color())?;
            } else {
                self.draw_line(ends[0], ends[1], style)?;
            }
        }
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        at: BackendCoord,
    ) -> Result<(), DrawingErrorKind<Infallible>> {
        let size = style.size();
        let (width, height) = (font::width(text, size) as i32, font::height(size) as i32);
        let left = match style.anchor().h_pos {
            HPos::Left => 0,
            HPos::Center => -width / 2,
            HPos::Right => -width,
        };
        let top = match style.anchor().v_pos {
            VPos::Top => 0,
            VPos::Center => -height / 2,
            VPos::Bottom => -height,
        };
        let (r, g, b) = style.color().rgb;
        let transform = style.transform();
        font::visit(text, size, &mut |x, y, coverage| {
            let (x, y) = (left + x as i32, top + y as i32);
            let (x, y) = match transform {
                FontTransform::None => (x, y),
                FontTransform::Rotate90 => (-y, x),
                FontTransform::Rotate180 => (-x, -y),
                FontTransform::Rotate270 => (y, -x),
            };
            if let (Ok(x), Ok(y)) = (usize::try_from(at.0 + x), usize::try_from(at.1 + y)) {
                self.0.blend(x, y, [r, g, b], coverage);
            }
        });
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        Ok((font::width(text, style.size()) as u32, font::height(style.size()) as u32))
    }
}
