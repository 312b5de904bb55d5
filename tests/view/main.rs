//! The live view: `abbe view` as a process, asked over HTTP and shown in a browser.

#![cfg(feature = "view")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../cli/abbe_command/mod.rs"]
mod abbe_command;
mod browser;
mod client;
mod devtools;

mod comparing;
mod editing;
mod explaining;
mod exporting;
mod gestures;
mod moving;
mod page;
mod photons;
mod rendering;
mod safety;
mod start;
mod web;
