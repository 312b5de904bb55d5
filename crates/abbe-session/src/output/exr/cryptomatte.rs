//! The attributes of Cryptomatte layers (specification 1.2.0).

use crate::output::Metadata;
use crate::output::metadata::escape_non_ascii;
use abbe_transport::sensor::cryptomatte::hash_name;
use abbe_transport::sensor::layers::MatteNames;
use serde_json::{Map, Value};

/// Returns the attributes of a layer. The manifest lists the hash of each name, as JSON.
pub(super) fn attributes(matte: &MatteNames) -> [(String, String); 4] {
    let hex = |hash: u32| format!("{hash:08x}");
    let key = &hex(hash_name(&matte.layer))[..7];
    let manifest: Map<String, Value> =
        matte.names.iter().map(|(name, hash)| (name.clone(), Value::String(hex(*hash)))).collect();
    let attribute = |name: &str, value: String| (format!("cryptomatte/{key}/{name}"), value);
    [
        attribute("name", matte.layer.clone()),
        attribute("hash", "MurmurHash3_32".to_string()),
        attribute("conversion", "uint32_to_float32".to_string()),
        attribute("manifest", escape_non_ascii(&Value::Object(manifest).to_string())),
    ]
}

pub(super) fn mattes(header: &Metadata) -> Vec<MatteNames> {
    let layer = |(attribute, layer): (&str, &str)| {
        let key = attribute.strip_prefix("cryptomatte/")?.strip_suffix("/name")?;
        let manifest: Map<String, Value> =
            serde_json::from_str(header.get(&format!("cryptomatte/{key}/manifest"))?).ok()?;
        let hash = |value: &Value| u32::from_str_radix(value.as_str()?, 16).ok();
        let names = manifest.iter().filter_map(|(name, value)| Some((name.clone(), hash(value)?))).collect();
        Some(MatteNames { layer: layer.to_string(), names })
    };
    header.iter().filter_map(layer).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The key of "CryptoObject" is known from files of other programs.
    #[test]
    fn attributes_have_the_names_of_the_specification() {
        let names = vec![("hello".to_string(), 0x248b_fa47), ("λ".to_string(), 0x3c25_69b2)];
        let [name, hash, conversion, manifest] = attributes(&MatteNames { layer: "CryptoObject".to_string(), names });
        assert_eq!(name, ("cryptomatte/3ae39a5/name".to_string(), "CryptoObject".to_string()));
        assert_eq!(hash.1, "MurmurHash3_32");
        assert_eq!(conversion.1, "uint32_to_float32");
        let header =
            [&name, &manifest].into_iter().fold(Metadata::new(), |header, (name, value)| header.with(name, value));
        assert_eq!(mattes(&header)[0].names.len(), 2);
        assert_eq!(manifest.1, r#"{"hello":"248bfa47","\u03bb":"3c2569b2"}"#);
    }
}
