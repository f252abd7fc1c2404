//! Threads: fixed chunks of work, so that results do not depend on how many threads share them.

use std::sync::Arc;

/// The threads of one world; one thread means that everything runs on the caller's.
#[derive(Debug, Clone, Default)]
pub(crate) struct Team {
    pool: Option<Arc<rayon::ThreadPool>>,
}

impl Team {
    pub(crate) fn new(threads: usize) -> Self {
        let pool = (threads > 1)
            .then(|| rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok())
            .flatten();
        Self { pool: pool.map(Arc::new) }
    }

    pub(crate) fn threads(&self) -> usize {
        self.pool.as_ref().map_or(1, |p| p.current_num_threads())
    }

    /// Run `work` on a thread of the team, so that its parallel loops start without a detour.
    pub(crate) fn enter<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

/// Run a block for every chunk of several slices that are cut alike, in parallel when `$threads`
/// is above one.
macro_rules! for_each_chunk {
    ($threads:expr, |$k:ident| $($name:ident in $slice:expr, $size:expr);+ => $body:block) => {{
        if $threads > 1 {
            use rayon::prelude::*;
            ($($slice.par_chunks_mut($size),)+)
                .into_par_iter()
                .enumerate()
                .for_each(|($k, ($($name,)+))| $body);
        } else {
            $(let mut $name = $slice.chunks_mut($size);)+
            let mut next = 0usize;
            while let ($(Some($name),)+) = ($($name.next(),)+) {
                let $k = next;
                next += 1;
                $body
            }
        }
    }};
}
pub(crate) use for_each_chunk;
