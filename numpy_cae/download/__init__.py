"""Download motion databases from their own sites, with the standard library alone."""

from numpy_cae.download.cmu import CmuSite, Tally, download_cmu
from numpy_cae.download.fetch import DownloadError, fetch

__all__ = ["CmuSite", "DownloadError", "Tally", "download_cmu", "fetch"]
