# The live page without a scene, web/kit.html: the library as WebAssembly, and
# scripts.  make page makes it, where there is clang for that; tarballs have it.
page_sources = web/page.h web/page.c web/describe.c web/pace.c web/crossing.c web/roots.c web/pair.c web/absent.c web/math.c \
	web/absent_code.c
page_parts = web/page.css web/page.html web/unpack.js web/engine.js web/view.js web/page.js web/draw.js web/section.js web/try.js \
	web/controls.js
page_scripts = web/module.sh web/kit.sh web/looks.awk web/gallery.sh
EXTRA_DIST += $(page_sources) $(page_parts) $(page_scripts)

page_packages = clang lld llvm wasi-libc libclang-rt-dev-wasm32 zopfli binaryen

.PHONY: page
if HAVE_KIT
page: web/kit.html
web/kit.html: web/local.mk $(page_sources) $(page_parts) $(page_scripts) \
  tools/report/lesson.c tools/report/lesson.h tools/plot/looks.h \
  $(libnevh_core_la_SOURCES)
	$(AM_V_GEN)$(MKDIR_P) web/objects
	$(AM_V_at)CC='$(WASM_CC)' AR='$(WASM_AR)' WASM_SYSROOT='$(WASM_SYSROOT)' \
	  GSL_INCLUDE='$(GSL_INCLUDE)' $(SHELL) $(srcdir)/web/module.sh \
	  $(srcdir) web/objects web/objects/nevh.wasm $(libnevh_core_la_SOURCES)
	$(AM_V_at)$(SHELL) $(srcdir)/web/kit.sh $(srcdir)/web web/objects/nevh.wasm >$@.new
	$(AM_V_at)rm -f $@ && mv $@.new $@
EXTRA_DIST += web/kit.html
else
page:
	@echo "the live page needs clang for WebAssembly; on Debian and Ubuntu" >&2
	@echo "  sudo apt-get install $(page_packages)" >&2
	@echo "then ./quickstart, or configure and make page" >&2
	@exit 1
endif

# Where it was made, or came with the tarball.
install-data-local:
	for kit in web/kit.html $(srcdir)/web/kit.html; do \
	  test -f $$kit || continue; \
	  $(MKDIR_P) "$(DESTDIR)$(pkgdatadir)" && \
	    $(INSTALL_DATA) $$kit "$(DESTDIR)$(pkgdatadir)/page.html" || exit 1; \
	  break; \
	done
uninstall-local:
	rm -f "$(DESTDIR)$(pkgdatadir)/page.html"
CLEANFILES += web/objects/*.o web/objects/*.log web/objects/library.a \
	web/objects/nevh.wasm web/objects/nevh.wasm.gz web/objects/nevh.wasm.text web/objects/include/gsl

# Pages of all scenes that ship, with an index, as they can be put on a site.
.PHONY: gallery
gallery: page tools/nevh$(EXEEXT)
	$(SHELL) $(srcdir)/web/gallery.sh ./tools/nevh$(EXEEXT) gallery \
	  $(srcdir)/scenes/*.nevh
