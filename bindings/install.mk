# Part of the Makefile: installation and distribution. Run `make` first, then:
#
# make install      installs the shared library with its SONAME and symlinks, the static library, headers, pkg-config
#                   and CMake files, licences, and the command line `luxfer` with the Python package that it runs (it
#                   needs python3 and numpy); the debug symbols and the symbol table of the shared library go into
#                   .debug/ beside it, where gdb looks for them; the names that programs link to stay in the library
# make uninstall    removes the installed files
# make dist         packs the last commit into out/luxfer-VERSION.tar.gz
#
# PREFIX=/usr/local   folder of the installation; its subfolders LIBDIR (such as $(PREFIX)/lib/x86_64-linux-gnu),
#                     INCLUDEDIR, DOCDIR, BINDIR and PYTHONDIR can be set too
# DESTDIR=            folder in which the installation is staged, for packages
# DEBUG=split         with DEBUG=keep, the libraries are installed as built, with their debug symbols: for packagers
#                     whose tools split them

PREFIX     ?= /usr/local
LIBDIR     ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
DOCDIR     ?= $(PREFIX)/share/doc/luxfer
BINDIR     ?= $(PREFIX)/bin
PYTHONDIR  ?= $(LIBDIR)/luxfer/python
INSTALL    ?= install
OBJCOPY    ?= objcopy
DEBUG      ?= split

HEADERS     := luxfer.h luxfer.hpp $(patsubst include/%,%,$(wildcard include/luxfer/*.h)) $(patsubst bindings/cpp/%,%,$(wildcard bindings/cpp/luxfer/*.hpp))
DOCUMENTS   := LICENSE-APACHE LICENSE-MIT README.md $(PROFILE)/THIRD-PARTY.txt
PACKAGE     := $(patsubst bindings/python/%,%,$(shell find bindings/python/luxfer -type f ! -path '*/__pycache__/*' ! -path '*/.*' ! -name '*.so'))
MODULES     := $(sort $(patsubst %/,%,$(dir $(PACKAGE))))
FOLDERS      = $(LIBDIR)/pkgconfig $(LIBDIR)/cmake/luxfer $(INCLUDEDIR)/luxfer $(DOCDIR) $(BINDIR) $(addprefix $(PYTHONDIR)/,$(MODULES))
INSTALLED    = $(addprefix $(LIBDIR)/,libluxfer.so libluxfer.so.$(ABI) libluxfer.so.$(VERSION) libluxfer.a pkgconfig/luxfer.pc \
                 $(SYMBOLS) cmake/luxfer/luxferConfig.cmake cmake/luxfer/luxferConfigVersion.cmake) \
               $(addprefix $(INCLUDEDIR)/,$(HEADERS)) $(addprefix $(DOCDIR)/,$(notdir $(DOCUMENTS))) \
               $(BINDIR)/luxfer $(addprefix $(PYTHONDIR)/,$(PACKAGE) luxfer/libluxfer.so)

# relative(from, to): the relative path between two folders, which need not exist.
relative = $(shell realpath -m --relative-to='$(1)' '$(2)')
# fill(template, folder): fills in a template and installs it into the folder.
fill = sed -e 's|@VERSION@|$(VERSION)|g' -e 's|@ABI@|$(ABI)|g' -e 's|@LIBRARY@|libluxfer.so.$(VERSION)|g' -e 's|@SONAME@|libluxfer.so.$(ABI)|g' \
         -e 's|@INCLUDEDIR@|$(call relative,$(2),$(INCLUDEDIR))|g' $(1) | $(INSTALL) -m 644 /dev/stdin '$(DESTDIR)$(2)/$(basename $(notdir $(1)))'

# The installed shared library, and the file for its debug symbols.
SHARED    = $(DESTDIR)$(LIBDIR)/libluxfer.so.$(VERSION)
SYMBOLS   = .debug/libluxfer.so.$(VERSION).debug

.PHONY: install uninstall dist

# Builds the library only if it is missing, so that after `make`, `sudo make install` needs no cargo.
$(LIB) $(PROFILE)/libluxfer.a:
	$(MAKE) lib

$(PROFILE)/THIRD-PARTY.txt: Cargo.lock
	@mkdir -p $(@D)
	CARGO='$(CARGO)' bindings/third_party.sh >$@.part && mv $@.part $@

install: $(LIB) $(PROFILE)/libluxfer.a $(PROFILE)/THIRD-PARTY.txt
	$(INSTALL) -d $(foreach folder,$(FOLDERS),'$(DESTDIR)$(folder)')
	$(INSTALL) -m 755 $(LIB) '$(DESTDIR)$(LIBDIR)/libluxfer.so.$(VERSION)'
	ln -sf libluxfer.so.$(VERSION) '$(DESTDIR)$(LIBDIR)/libluxfer.so.$(ABI)'
	ln -sf libluxfer.so.$(ABI) '$(DESTDIR)$(LIBDIR)/libluxfer.so'
	$(INSTALL) -m 644 $(PROFILE)/libluxfer.a '$(DESTDIR)$(LIBDIR)'
ifeq ($(DEBUG),split)
	$(INSTALL) -d '$(DESTDIR)$(LIBDIR)/.debug'
	$(OBJCOPY) --only-keep-debug '$(SHARED)' '$(DESTDIR)$(LIBDIR)/$(SYMBOLS)'
	chmod 644 '$(DESTDIR)$(LIBDIR)/$(SYMBOLS)'
	cd '$(DESTDIR)$(LIBDIR)' && $(OBJCOPY) --strip-all --add-gnu-debuglink=$(SYMBOLS) libluxfer.so.$(VERSION)
	$(OBJCOPY) --strip-debug '$(DESTDIR)$(LIBDIR)/libluxfer.a'
endif
	$(INSTALL) -m 644 include/luxfer.h bindings/cpp/luxfer.hpp '$(DESTDIR)$(INCLUDEDIR)'
	$(INSTALL) -m 644 include/luxfer/*.h bindings/cpp/luxfer/*.hpp '$(DESTDIR)$(INCLUDEDIR)/luxfer'
	$(INSTALL) -m 644 $(DOCUMENTS) '$(DESTDIR)$(DOCDIR)'
	$(call fill,bindings/pkgconfig/luxfer.pc.in,$(LIBDIR)/pkgconfig)
	$(call fill,bindings/cmake/luxferConfig.cmake.in,$(LIBDIR)/cmake/luxfer)
	$(call fill,bindings/cmake/luxferConfigVersion.cmake.in,$(LIBDIR)/cmake/luxfer)
	for file in $(PACKAGE); do $(INSTALL) -m 644 "bindings/python/$$file" "$(DESTDIR)$(PYTHONDIR)/$$file" || exit 1; done
	ln -sf '$(call relative,$(PYTHONDIR)/luxfer,$(LIBDIR))/libluxfer.so.$(ABI)' '$(DESTDIR)$(PYTHONDIR)/luxfer/libluxfer.so'
	sed 's|@PYTHONDIR@|$(call relative,$(BINDIR),$(PYTHONDIR))|' bindings/python/luxfer.in >'$(DESTDIR)$(BINDIR)/luxfer'
	chmod 755 '$(DESTDIR)$(BINDIR)/luxfer'

# Removes the files that `make install` has installed, with the bytecode that Python has compiled of them, and their
# folders, the inner ones first, if they are then empty.
uninstall:
	rm -f $(foreach file,$(INSTALLED),'$(DESTDIR)$(file)')
	rm -rf $(foreach folder,$(MODULES),'$(DESTDIR)$(PYTHONDIR)/$(folder)/__pycache__')
	for folder in $(foreach folder,$(FOLDERS) $(PYTHONDIR) $(LIBDIR)/luxfer $(LIBDIR)/.debug,'$(DESTDIR)$(folder)'); do \
	  echo "$$folder"; done | sort -r | while read -r folder; do rmdir "$$folder" 2>/dev/null || true; done

dist:
	@mkdir -p out
	git archive --prefix=luxfer-$(VERSION)/ -o out/luxfer-$(VERSION).tar.gz HEAD
	@echo out/luxfer-$(VERSION).tar.gz
