//! A glTF file that uses what the readers know, for changes of its structure.

/// Returns the text of the file, whose buffers and pictures are inside it.
pub(crate) fn text() -> String {
    let floats = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let faces: [u16; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
    let mut bytes: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend(faces.iter().flat_map(|index| index.to_le_bytes()));
    let identity = (0..16).map(|i| if i % 5 == 0 { 1.0_f32 } else { 0.0 });
    bytes.extend(identity.flat_map(f32::to_le_bytes));
    bytes.extend([0_u8; 64]);
    let picture = super::targets::png();
    bytes.extend(&picture);
    let buffer = base64(&bytes);
    TEXT.replace("BUFFER", &format!("data:application/octet-stream;base64,{buffer}"))
        .replace("PICTURE", &format!("data:image/png;base64,{}", base64(&picture)))
        .replace("\"LENGTH\"", &bytes.len().to_string())
        .replace("\"PNG\"", &picture.len().to_string())
}

fn base64(bytes: &[u8]) -> String {
    use base64::Engine as _;
    base64::engine::general_purpose::STANDARD.encode(bytes)
}

/// The buffer holds 4 positions, 12 indices, a matrix, zeros and a picture.
const TEXT: &str = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 3, 4, 5]}],
"extensionsUsed": ["KHR_lights_punctual", "EXT_mesh_gpu_instancing", "EXT_lights_ies"],
"extensions": {"KHR_lights_punctual": {"lights": [
    {"type": "spot", "color": [1, 0.5, 0.5], "intensity": 9, "range": 5, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.5}},
    {"type": "directional"}]}, "EXT_lights_ies": {"lights": [{"uri": "a.ies"}]}},
"nodes": [
    {"name": "body", "children": [1, 2], "rotation": [0, 0, 0, 1], "scale": [1, 1, 2]},
    {"mesh": 0, "skin": 0, "weights": [0.5]},
    {"mesh": 1, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}},
    {"camera": 0, "translation": [0, 0, 5]}, {"camera": 1},
    {"extensions": {"KHR_lights_punctual": {"light": 0}, "KHR_node_visibility": {"visible": true}}}],
"skins": [{"joints": [0], "inverseBindMatrices": 2, "skeleton": 0}],
"cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1, "zfar": 9, "aspectRatio": 1}},
    {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 9}}],
"animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
    "samplers": [{"input": 3, "output": 4, "interpolation": "LINEAR"}]}],
"meshes": [{"name": "m", "weights": [1], "primitives": [
    {"attributes": {"POSITION": 0, "NORMAL": 0, "COLOR_0": 0, "JOINTS_0": 5, "WEIGHTS_0": 6, "TEXCOORD_0": 7},
     "indices": 1, "material": 0, "mode": 4, "targets": [{"POSITION": 0}]}]},
    {"primitives": [{"attributes": {"POSITION": 8}, "material": 1}]}],
"materials": [
    {"name": "glass", "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": true, "emissiveFactor": [1, 0, 0],
     "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "baseColorTexture": {"index": 0, "texCoord": 0,
        "extensions": {"KHR_texture_transform": {"offset": [0, 0], "rotation": 0.1, "scale": [2, 2], "texCoord": 0}}},
        "metallicFactor": 0, "roughnessFactor": 0.5, "metallicRoughnessTexture": {"index": 1}},
     "normalTexture": {"index": 0, "scale": 0.5}, "occlusionTexture": {"index": 0, "strength": 1}, "emissiveTexture": {"index": 1},
     "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1, "transmissionTexture": {"index": 0}},
        "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0.5]},
        "KHR_materials_ior": {"ior": 1.5}, "KHR_materials_dispersion": {"dispersion": 0.3},
        "KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceThicknessTexture": {"index": 0}},
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.5}, "KHR_materials_emissive_strength": {"emissiveStrength": 3}}},
    {"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.5, 0.5, 0.5, 1],
        "diffuseTexture": {"index": 0}, "specularGlossinessTexture": {"index": 1}},
        "KHR_materials_specular": {"specularFactor": 0.5}, "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5}}}],
"textures": [{"source": 0, "sampler": 0}, {"extensions": {"EXT_texture_webp": {"source": 1}}}],
"samplers": [{"magFilter": 9728, "minFilter": 9987, "wrapS": 33071, "wrapT": 10497}],
"images": [{"bufferView": 4, "mimeType": "image/png", "name": "a"}, {"uri": "PICTURE"}],
"accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
    {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"},
    {"bufferView": 2, "componentType": 5126, "count": 1, "type": "MAT4"},
    {"bufferView": 0, "byteOffset": 8, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
    {"bufferView": 0, "componentType": 5126, "count": 2, "type": "VEC3"},
    {"bufferView": 3, "componentType": 5121, "count": 4, "type": "VEC4"},
    {"bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC4"},
    {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC2"},
    {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0],
     "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}}],
"bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24, "target": 34963},
    {"buffer": 0, "byteOffset": 72, "byteLength": 64}, {"buffer": 0, "byteOffset": 136, "byteLength": 64},
    {"buffer": 0, "byteOffset": 200, "byteLength": "PNG"}],
"buffers": [{"uri": "BUFFER", "byteLength": "LENGTH"}]}"#;
