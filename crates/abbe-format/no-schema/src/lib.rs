//! A derive macro that takes the place of `schemars::JsonSchema` where no schema is generated.
//!
//! The types of the scene file describe their schema in `#[schemars(…)]` attributes. Only the tests
//! generate the schema, and its code takes a sixth of the compile time of `abbe-format`. Without
//! the feature `schema`, `abbe-format` therefore derives this macro, which accepts the attributes
//! and generates nothing.

use proc_macro::TokenStream;

/// Accepts `#[schemars(…)]` attributes and generates nothing.
#[proc_macro_derive(JsonSchema, attributes(schemars))]
pub fn json_schema(_: TokenStream) -> TokenStream {
    TokenStream::new()
}
