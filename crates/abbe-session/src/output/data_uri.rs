//! `data:` URIs (RFC 2397), which embed files in a page.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;

/// Returns the `data:` URI of a file with a media type such as `image/png`.
pub fn data_uri(media_type: &str, bytes: &[u8]) -> String {
    format!("data:{media_type};base64,{}", BASE64_STANDARD.encode(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_uri_states_its_media_type_and_is_padded() {
        assert_eq!(data_uri("text/plain", b"fooba"), "data:text/plain;base64,Zm9vYmE=");
        assert_eq!(data_uri("image/png", &[0xfb, 0xff, 0xfe]), "data:image/png;base64,+//+");
    }
}
