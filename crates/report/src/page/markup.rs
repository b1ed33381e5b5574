//! Text for HTML, bytes for JSON.

/// Returns the text as it stands in HTML, in content or between double quotes.
pub(super) fn escaped(text: &str) -> String {
    let mut html = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => html.push_str("&amp;"),
            '<' => html.push_str("&lt;"),
            '>' => html.push_str("&gt;"),
            '"' => html.push_str("&quot;"),
            '\'' => html.push_str("&#39;"),
            // HTML has no way to write these.
            '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{7f}' => html.push('\u{fffd}'),
            _ => html.push(character),
        }
    }
    html
}

/// Returns JSON as it stands in a script element: nothing in it opens or closes an element or a comment.
pub(super) fn json_in_script(json: &str) -> String {
    json.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

/// Returns the template with `{{place}}` filled in; what is filled in is not looked at again.
pub(super) fn fill(template: &str, content: impl Fn(&str) -> String) -> String {
    let mut pieces = template.split("{{");
    let mut page = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (place, rest) = piece.split_once("}}").unwrap_or(("", piece));
        page.push_str(&content(place));
        page.push_str(rest);
    }
    page
}

/// Returns bytes in base 64 (RFC 4648, section 4).
pub(super) fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let bits = (0..3).fold(0, |bits, i| bits << 8 | u32::from(three.get(i).copied().unwrap_or(0)));
        for digit in 0..4 {
            let place = bits >> (18 - 6 * digit) & 63;
            text.push(if digit <= three.len() { char::from(DIGITS[place as usize]) } else { '=' });
        }
    }
    text
}

/// Returns numbers in single precision, little end first, in base 64.
pub(super) fn singles(numbers: impl Iterator<Item = f64>) -> String {
    base64(&numbers.flat_map(|number| (number as f32).to_le_bytes()).collect::<Vec<u8>>())
}

/// Returns numbers in double precision, little end first, in base 64.
pub(super) fn doubles(numbers: impl Iterator<Item = f64>) -> String {
    base64(&numbers.flat_map(f64::to_le_bytes).collect::<Vec<u8>>())
}

/// Returns a number with about three digits, as people read it, with a true minus.
pub(super) fn plain(value: f64) -> String {
    let size = value.abs();
    let text = match () {
        () if value == 0.0 => "0".to_owned(),
        () if !(1e-3..1e5).contains(&size) => format!("{value:.2e}"),
        () => {
            let decimals = (2 - size.log10().floor() as i32).clamp(0, 5) as usize;
            format!("{value:.decimals$}")
        }
    };
    text.replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_64_is_the_standard_one() {
        // RFC 4648, section 10.
        let words = ["", "f", "fo", "foo", "foob", "fooba", "foobar"];
        let coded = ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"];
        for (word, coded) in words.iter().zip(coded) {
            assert_eq!(base64(word.as_bytes()), coded);
        }
    }

    #[test]
    fn what_is_filled_in_is_not_filled_in_again() {
        let page = fill("a {{x}} b {{y}} c", |place| format!("[{place} {{{{x}}}}]"));
        assert_eq!(page, "a [x {{x}}] b [y {{x}}] c");
    }

    #[test]
    fn hostile_text_stays_text() {
        assert_eq!(escaped("</script>&\"'\u{1}"), "&lt;/script&gt;&amp;&quot;&#39;\u{fffd}");
        assert!(!json_in_script("\"</script><!--\"").contains(['<', '>']));
    }

    #[test]
    fn numbers_read_well() {
        let read = [0.0, -0.5, 1234.5, 0.012_345, 1.5e-7, 99_999.0].map(plain);
        assert_eq!(read, ["0", "\u{2212}0.500", "1234", "0.0123", "1.50e\u{2212}7", "99999"]);
    }
}
