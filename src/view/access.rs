//! Decides which requests the server answers. Pages of other sites must not reach it, even if their
//! domain name points to this machine (DNS rebinding). The first segment of each path is a random
//! token. The `Host` header must name an IP address or `localhost`, because rebinding needs a
//! domain name. An `Origin` must be the address of the page itself.

use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;
use std::net::{IpAddr, SocketAddr};

/// Returns a random text of 128 bits in hexadecimal digits. The system seeds `RandomState`.
pub(super) fn random_token() -> String {
    let word = |salt: &str| RandomState::new().hash_one((salt, std::process::id(), std::time::SystemTime::now()));
    format!("{:016x}{:016x}", word("first"), word("second"))
}

/// The rules for requests.
#[derive(Debug)]
pub(super) struct Access {
    token: String,
    address: SocketAddr,
}

impl Access {
    pub(super) fn new(token: &str, address: SocketAddr) -> Self {
        Self { token: token.to_string(), address }
    }

    /// Returns true if the headers `Host` and `Origin` are those of the page.
    pub(super) fn allows(&self, host: Option<&str>, origin: Option<&str>) -> bool {
        let Some(host) = host else { return false };
        let is_page = |origin: &str| origin.strip_prefix("http://") == Some(host);
        self.is_own_host(host) && origin.is_none_or(is_page)
    }

    /// Returns the rest of a path after the token, or `None` if the token is wrong.
    pub(super) fn after_token<'p>(&self, path: &'p str) -> Option<&'p str> {
        let (token, rest) = path.strip_prefix('/')?.split_once('/')?;
        // The time of the comparison does not depend on the first wrong character.
        let differs = token.bytes().zip(self.token.bytes()).fold(0, |sum, (a, b)| sum | (a ^ b));
        (token.len() == self.token.len() && differs == 0).then_some(rest)
    }

    fn is_own_host(&self, host: &str) -> bool {
        let (name, port) = host.rsplit_once(':').map_or((host, "80"), |(name, port)| (name, port));
        if port.parse() != Ok(self.address.port()) {
            return false;
        }
        let name = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
        match name.parse::<IpAddr>() {
            Ok(ip) => !self.address.ip().is_loopback() || ip.is_loopback(),
            Err(_) => name.eq_ignore_ascii_case("localhost"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn access(bind: &str) -> Access {
        Access::new("abc", bind.parse().unwrap())
    }

    #[test]
    fn only_the_page_itself_is_allowed() {
        let loopback = access("127.0.0.1:8000");
        for (host, origin, allowed) in [
            (Some("127.0.0.1:8000"), None, true),
            (Some("localhost:8000"), Some("http://localhost:8000"), true),
            (Some("[::1]:8000"), None, true),
            (None, None, false),
            (Some("127.0.0.1:8001"), None, false),
            (Some("127.0.0.1"), None, false),
            (Some("evil.example:8000"), None, false),
            (Some("192.168.1.5:8000"), None, false),
            (Some("127.0.0.1:8000"), Some("http://evil.example"), false),
            (Some("127.0.0.1:8000"), Some("null"), false),
            (Some("127.0.0.1:8000"), Some("https://127.0.0.1:8000"), false),
        ] {
            assert_eq!(loopback.allows(host, origin), allowed, "{host:?} {origin:?}");
        }
        let everywhere = access("0.0.0.0:8000");
        assert!(everywhere.allows(Some("192.168.1.5:8000"), None));
        assert!(!everywhere.allows(Some("evil.example:8000"), None));
    }

    #[test]
    fn paths_start_with_the_token() {
        let access = access("127.0.0.1:8000");
        assert_eq!(access.after_token("/abc/"), Some(""));
        assert_eq!(access.after_token("/abc/state"), Some("state"));
        assert!(["/", "/abc", "/abd/", "/ab/", "/abcd/", "abc/"].iter().all(|path| access.after_token(path).is_none()));
    }

    #[test]
    fn tokens_are_long_and_different() {
        let tokens: Vec<String> = (0..8).map(|_| random_token()).collect();
        assert!(tokens.iter().all(|token| token.len() == 32));
        assert!((1..8).all(|i| !tokens[..i].contains(&tokens[i])));
    }
}
